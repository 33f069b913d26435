// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/tum_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "hal/playback/depth_image.h"
#include "hal/playback/frame_reel.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxListBytes = std::size_t{64} << 20;
constexpr double kDepthScaleMm = 0.2;  ///< 5000 units are a metre
constexpr double kLatestSecond = 4e9;
constexpr std::chrono::milliseconds kTolerance{20};

struct Entry {
  CaptureTime time;
  fs::path file;
};

[[noreturn]] void refuse(const fs::path& list, int line, const std::string& what) {
  throw InputError(fmt::format("{}:{}", list.string(), line), what, "lines are \"seconds filename\"");
}

bool stays_inside(const fs::path& file) {
  if (file.empty() || file.is_absolute()) return false;
  for (const fs::path& part : file) {
    if (part == "..") return false;
  }
  return true;
}

/// One line that is neither empty nor a comment.
Entry parse_line(std::string_view text, const fs::path& list, int line) {
  double seconds = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || !(seconds >= 0 && seconds < kLatestSecond)) {
    refuse(list, line, "does not begin with a time");
  }
  std::string_view name = text.substr(static_cast<std::size_t>(rest - text.data()));
  while (!name.empty() && (name.front() == ' ' || name.front() == '\t')) name.remove_prefix(1);
  while (!name.empty() && (name.back() == ' ' || name.back() == '\r')) name.remove_suffix(1);
  const fs::path file{std::string(name)};
  if (!stays_inside(file)) refuse(list, line, "names no file inside the folder");
  return {CaptureTime(std::chrono::nanoseconds(std::llround(seconds * 1e9))), list.parent_path() / file};
}

std::vector<Entry> read_list(const fs::path& list) {
  const std::vector<std::byte> bytes = read_file_bytes(list, kMaxListBytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<Entry> entries;
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++number;
    if (line.empty() || line == "\r" || line.front() == '#') continue;
    entries.push_back(parse_line(line, list, number));
    if (entries.size() > 1 && entries.back().time <= entries[entries.size() - 2].time) {
      refuse(list, number, "is not later than the line before it");
    }
  }
  if (entries.empty()) throw InputError(list.string(), "lists no image");
  return entries;
}

/// Index of the entry nearest in time. `entries` is not empty.
std::size_t nearest(const std::vector<Entry>& entries, CaptureTime time) {
  const auto after = std::lower_bound(entries.begin(), entries.end(), time,
                                      [](const Entry& e, CaptureTime t) { return e.time < t; });
  auto best = after == entries.end() ? after - 1 : after;
  if (after != entries.begin() && time - (after - 1)->time <= best->time - time) best = after - 1;
  return static_cast<std::size_t>(best - entries.begin());
}

/// The published calibrations of the benchmark's three Kinects (its page "Intrinsic Camera Calibration").
std::optional<CameraFile> published_camera(const std::string& folder_name) {
  CameraFile file;
  file.depth_scale_mm = kDepthScaleMm;
  CameraModel& c = file.camera;
  c.width = 640;
  c.height = 480;
  const auto set = [&](double fx, double fy, double cx, double cy) {
    c.fx = fx;
    c.fy = fy;
    c.cx = cx;
    c.cy = cy;
  };
  if (folder_name.find("freiburg1") != std::string::npos) {
    set(517.3, 516.5, 318.6, 255.3);
    c.distortion = {0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
  } else if (folder_name.find("freiburg2") != std::string::npos) {
    set(520.9, 521.0, 325.1, 249.7);
    c.distortion = {0.2312, -0.7849, -0.0033, -0.0001, 0.9172};
  } else if (folder_name.find("freiburg3") != std::string::npos) {
    set(535.4, 539.2, 320.1, 247.6);
  } else {
    return std::nullopt;
  }
  return file;
}

CameraFile camera_of(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "camera.yaml", error)) return read_camera_file(folder / "camera.yaml");
  fs::path named = fs::absolute(folder, error).lexically_normal();
  if (named.filename().empty()) named = named.parent_path();
  if (auto known = published_camera(named.filename().string())) return *known;
  throw InputError(folder.string(),
                   "has no camera.yaml, and its name tells no freiburg1, freiburg2 or freiburg3",
                   "write the calibration into camera.yaml (see sextant detect --help), depth_scale_mm: 0.2");
}

class TumReel final : public FrameReel {
 public:
  explicit TumReel(TumDataset dataset) : dataset_(std::move(dataset)) {}
  std::size_t size() const override { return dataset_.pairs.size(); }
  std::optional<CaptureStamp> captured(std::size_t i) const override {
    const CaptureTime at = dataset_.pairs[i].captured_at;
    // The list has one clock only: it stands for both.
    return CaptureStamp{MonotonicTime(at.time_since_epoch()), at};
  }
  RgbdFrame load(std::size_t i) const override {
    const TumPair& pair = dataset_.pairs[i];
    RgbdFrame frame;
    frame.colour = read_colour_image(pair.colour);
    frame.axial_depth_m = depth_in_metres(read_depth_image(pair.depth), dataset_.camera.depth_scale_mm);
    require_same_size(frame.colour, pair.colour, frame.axial_depth_m, pair.depth);
    if (frame.colour.cols != dataset_.camera.camera.width ||
        frame.colour.rows != dataset_.camera.camera.height) {
      throw InputError(
          pair.colour.string(),
          fmt::format("has {} x {} pixels, the calibration is for {} x {}", frame.colour.cols,
                      frame.colour.rows, dataset_.camera.camera.width, dataset_.camera.camera.height),
          "write the calibration of this size into camera.yaml");
    }
    frame.camera = dataset_.camera.camera;
    frame.table = dataset_.camera.table;
    const CaptureStamp stamp = *captured(i);
    frame.captured_at = stamp.realtime;
    frame.captured_monotonic = stamp.monotonic;
    frame.sequence = static_cast<std::int64_t>(i);
    frame.image_id = frame.sequence;
    return frame;
  }
  std::vector<std::string> remarks() const override { return dataset_.remarks; }

 private:
  TumDataset dataset_;
};

}  // namespace

TumDataset open_tum_dataset(const fs::path& folder) {
  TumDataset dataset;
  dataset.camera = camera_of(folder);
  const std::vector<Entry> colours = read_list(folder / "rgb.txt");
  const std::vector<Entry> depths = read_list(folder / "depth.txt");
  for (const Entry& colour : colours) {
    const Entry& depth = depths[nearest(depths, colour.time)];
    const auto gap = std::chrono::abs(depth.time - colour.time);
    if (gap > kTolerance || &colours[nearest(colours, depth.time)] != &colour) continue;
    dataset.pairs.push_back({colour.time, colour.file, depth.file});
  }
  if (dataset.pairs.empty()) {
    throw InputError(folder.string(), "no colour image has a depth image within 20 ms",
                     "check that rgb.txt and depth.txt are of one recording");
  }
  if (const std::size_t alone = colours.size() - dataset.pairs.size(); alone > 0) {
    dataset.remarks.push_back(
        fmt::format("{} of {} colour images have no depth image within 20 ms", alone, colours.size()));
  }
  return dataset;
}

bool is_tum_folder(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "rgb.txt", error) && fs::exists(folder / "depth.txt", error);
}

std::unique_ptr<FrameReel> open_tum_reel(const ReelOptions& options) {
  TumDataset dataset = open_tum_dataset(options.dataset);
  if (options.image >= 0) {
    const auto wanted = static_cast<std::size_t>(options.image);
    if (wanted >= dataset.pairs.size()) {
      throw InputError(options.dataset.string(), "holds no image " + std::to_string(options.image),
                       fmt::format("there are 0 to {}", dataset.pairs.size() - 1));
    }
    dataset.pairs = {dataset.pairs[wanted]};
  }
  return std::make_unique<TumReel>(std::move(dataset));
}

}  // namespace sextant
