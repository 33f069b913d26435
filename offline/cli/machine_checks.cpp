// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/machine_checks.h"

#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include "hal/dds/loopback_check.h"
#include "offline/render/egl_context.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr double kGigabyte = 1e9;
constexpr long kWantedSocketBuffer = 4L << 20;  ///< bytes: several images of 640 x 480 depth
constexpr long kMostBytes = 1 << 20;            ///< of any file in /proc that is read

std::string read_text(const fs::path& file) {
  std::ifstream in(file);
  std::string text;
  char buffer[4096];
  while (in.read(buffer, sizeof buffer) || in.gcount() > 0) {
    text.append(buffer, static_cast<std::size_t>(in.gcount()));
    if (text.size() > static_cast<std::size_t>(kMostBytes)) break;
  }
  return text;
}

std::optional<long> read_number(const fs::path& file) {
  std::istringstream in(read_text(file));
  long value = 0;
  if (in >> value) return value;
  return std::nullopt;
}

/// The rest of the first line that begins with a word.
std::string line_after(const std::string& text, const std::string& word) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(word, 0) != 0) continue;
    const std::size_t colon = line.find(':');
    return colon == std::string::npos ? "" : line.substr(colon + 1);
  }
  return "";
}

bool has_word(const std::string& words, const std::string& word) {
  std::istringstream in(words);
  for (std::string w; in >> w;) {
    if (w == word) return true;
  }
  return false;
}

}  // namespace

std::vector<Finding> check_processor(const MachinePlaces& places) {
  std::vector<Finding> out;
  const std::string cpuinfo = read_text(places.root / "proc/cpuinfo");
  const std::string x86 = line_after(cpuinfo, "flags");
  const std::string arm = line_after(cpuinfo, "Features");
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  std::string simd;
  for (const char* flag : {"avx512f", "avx2", "sse4_2"}) {
    if (simd.empty() && has_word(x86, flag)) simd = flag;
  }
  if (has_word(arm, "asimd")) simd = "neon";
  if (simd.empty()) {
    out.push_back({FindingState::kWarning, "processor",
                   fmt::format("{} cores, no AVX2 and no NEON seen", cores),
                   "the search works, but slowly; use a newer processor"});
  } else {
    out.push_back({simd == "sse4_2" ? FindingState::kNote : FindingState::kGood, "processor",
                   fmt::format("{} cores, {}", cores, simd), ""});
  }
  std::string governor = read_text(places.root / "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  governor.erase(std::remove(governor.begin(), governor.end(), '\n'), governor.end());
  if (governor == "powersave" || governor == "conservative") {
    out.push_back({FindingState::kWarning, "frequency", "the governor is " + governor,
                   "cpupower frequency-set -g performance (or schedutil), for steady search times"});
  }
  return out;
}

std::vector<Finding> check_memory(const MachinePlaces& places) {
  std::istringstream in(line_after(read_text(places.root / "proc/meminfo"), "MemAvailable"));
  double kilobytes = 0;
  if (!(in >> kilobytes)) return {{FindingState::kNote, "memory", "/proc/meminfo cannot be read", ""}};
  const double gigabytes = kilobytes * 1024 / kGigabyte;
  const std::string what = fmt::format("{:.1f} GB available", gigabytes);
  // The daemon takes 0.2 GB and 2 MB a model; compiling takes up to 1 GB a thread.
  if (gigabytes < 0.5)
    return {{FindingState::kBad, "memory", what, "the daemon needs 0.5 GB: end other programs"}};
  if (gigabytes < 2) {
    return {
        {FindingState::kWarning, "memory", what, "enough for detection; compile models on a larger machine"}};
  }
  return {{FindingState::kGood, "memory", what, ""}};
}

std::vector<Finding> check_socket_buffers(const MachinePlaces& places) {
  const auto limit = read_number(places.root / "proc/sys/net/core/rmem_max");
  if (!limit) return {{FindingState::kNote, "socket buffers", "net.core.rmem_max cannot be read", ""}};
  const std::string what = fmt::format("net.core.rmem_max is {} bytes", *limit);
  if (*limit >= kWantedSocketBuffer) return {{FindingState::kGood, "socket buffers", what, ""}};
  return {{FindingState::kWarning, "socket buffers", what + ": images over DDS will be lost or late",
           "as root: sysctl -w net.core.rmem_max=8388608, and the same in /etc/sysctl.d/60-sextant.conf"}};
}

std::vector<Finding> check_camera_permissions(const MachinePlaces& places) {
  std::vector<Finding> out;
  std::error_code error;
  int usable = 0;
  for (fs::directory_iterator it(places.root / "dev", error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.rfind("video", 0) != 0 || name.size() < 6 || name[5] < '0' || name[5] > '9') continue;
    if (::access(it->path().c_str(), R_OK | W_OK) == 0) {
      ++usable;
    } else {
      out.push_back(
          {FindingState::kBad, "cameras", "/dev/" + name + " may not be opened by this user",
           "add the user to the group video (usermod -aG video NAME, then log in again), or install "
           "config/60-sextant-cameras.rules into /etc/udev/rules.d"});
    }
  }
  if (usable > 0) {
    out.push_back({FindingState::kGood, "cameras", fmt::format("{} V4L2 nodes can be opened", usable), ""});
  } else if (out.empty()) {
    out.push_back(
        {FindingState::kNote, "cameras", "no V4L2 device: cameras over DDS and playback still work", ""});
  }
  return out;
}

std::vector<Finding> check_clock() {
  timex state{};
  const int code = ::adjtimex(&state);
  if (code < 0) return {{FindingState::kNote, "clock", "its state cannot be read", ""}};
  if ((state.status & STA_UNSYNC) != 0 || code == TIME_ERROR) {
    return {{FindingState::kNote, "clock", "the wall clock is not synchronised",
             "only cameras and readers on other machines need it: chrony or systemd-timesyncd"}};
  }
  return {
      {FindingState::kGood, "clock", fmt::format("synchronised, estimated error {} us", state.esterror), ""}};
}

std::vector<Finding> check_dds(unsigned domain) {
  std::vector<Finding> out;
  if (std::getenv("CYCLONEDDS_URI") == nullptr) {
    out.push_back({FindingState::kNote, "DDS settings", "CYCLONEDDS_URI is not set: Cyclone's own defaults",
                   "for one machine: CYCLONEDDS_URI=file:///.../config/cyclonedds.xml"});
  }
  const LoopbackResult r = check_dds_loopback(domain);
  if (!r.problem.empty()) {
    out.push_back({FindingState::kBad, "DDS", r.problem,
                   "check the network interface; on a machine without multicast use config/cyclonedds.xml"});
    return out;
  }
  const std::string what =
      fmt::format("{} of {} images of 614 kB came through, median {:.1f} ms, found each other in {:.0f} ms",
                  r.received, r.sent, r.median_ms, r.discovery_ms);
  if (r.received == 0) {
    out.push_back({FindingState::kBad, "DDS", what, "enlarge the socket buffers (see above)"});
  } else if (r.received < r.sent - 1 || r.median_ms > 20) {
    out.push_back({FindingState::kWarning, "DDS", what, "enlarge the socket buffers (see above)"});
  } else {
    out.push_back({FindingState::kGood, "DDS", what, ""});
  }
  return out;
}

std::vector<Finding> check_rendering() {
  try {
    const EglContext context;
    context.make_current();
    return {{FindingState::kGood, "rendering", context.driver(), ""}};
  } catch (const DoorError& error) {
    return {{FindingState::kWarning, "rendering", error.what(),
             "only compile, render and synthesize need it: install libegl1 and libgl1-mesa-dri"}};
  }
}

std::vector<Finding> check_models(const std::vector<fs::path>& models) {
  std::vector<Finding> out;
  for (const fs::path& file : models) {
    try {
      const ObjectModel model = read_model(file);
      out.push_back({FindingState::kGood, "model",
                     fmt::format("{}: {} (object {}), {} bins", file.string(), model.name, model.object_id,
                                 model.bins.size()),
                     ""});
    } catch (const DoorError& error) {
      out.push_back({FindingState::kBad, "model", error.what(), "compile it again with sextant compile"});
    }
  }
  return out;
}

std::vector<Finding> check_disk(const fs::path& folder) {
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) != 0) {
    return {{FindingState::kNote, "disk", folder.string() + " cannot be looked at", ""}};
  }
  const double gigabytes =
      static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) / kGigabyte;
  const std::string what = fmt::format("{:.1f} GB free", gigabytes);
  if (gigabytes < 1) {
    return {{FindingState::kWarning, "disk", what, "a recording takes about 1 MB a frame: make space"}};
  }
  return {{FindingState::kGood, "disk", what, ""}};
}

}  // namespace sextant
