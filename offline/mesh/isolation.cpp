// SPDX-License-Identifier: Apache-2.0
// fork + setrlimit + a pipe. The child leaves with _exit so that nothing of the parent's is run twice.
#include "offline/mesh/isolation.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "runtime/base/error.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SEXTANT_SHADOW_MEMORY 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SEXTANT_SHADOW_MEMORY 1
#endif
#endif

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

[[maybe_unused]] rlim_t address_space_in_use() {
  unsigned long pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;  // NOLINT(cert-err34-c)
    std::fclose(file);
  }
  return rlim_t{pages} * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

void limit(int resource, rlim_t value) {
  const rlimit both{value, value};
  setrlimit(static_cast<__rlimit_resource>(resource), &both);
}

void enter_cage(const IsolationLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGPIPE, SIGXCPU}) {
    std::signal(signal, SIG_DFL);
  }
  const int null = open("/dev/null", O_RDWR);
  for (int stream : {0, 1, 2}) {
    if (null >= 0) dup2(null, stream);
  }
#ifndef SEXTANT_SHADOW_MEMORY  // sanitizers reserve terabytes of address space
  limit(RLIMIT_AS, address_space_in_use() + limits.memory_bytes);
#endif
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(std::max(1.0, limits.cpu_s))));
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
}

[[noreturn]] void run_child(const std::function<std::vector<std::byte>()>& work,
                            const IsolationLimits& limits, int answer) {
  int code = 1;
  try {
    enter_cage(limits);
    const std::vector<std::byte> bytes = work();
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const ssize_t n = write(answer, bytes.data() + sent, bytes.size() - sent);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      sent += static_cast<std::size_t>(n);
    }
    code = sent == bytes.size() ? 0 : 1;
  } catch (...) {
    code = 2;
  }
  _exit(code);
}

// Reads until the child closes its end. Returns why it was given up, or nothing.
std::string collect(int answer, const IsolationLimits& limits, std::vector<std::byte>& bytes) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limits.wall_s));
  std::array<std::byte, 65536> chunk{};
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return "took too long";
    pollfd waiting{answer, POLLIN, 0};
    const int ready = poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 60000)));
    if (ready < 0 && errno != EINTR) return std::string("cannot wait for it: ") + std::strerror(errno);
    if (ready <= 0) continue;
    const ssize_t n = read(answer, chunk.data(), chunk.size());
    if (n == 0) return "";
    if (n < 0) {
      if (errno == EINTR) continue;
      return std::string("cannot hear it: ") + std::strerror(errno);
    }
    const auto count = static_cast<std::size_t>(n);
    if (count > limits.answer_bytes - bytes.size()) return "gave too much data";
    bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + n);
  }
}

}  // namespace

IsolatedAnswer run_isolated(const std::function<std::vector<std::byte>()>& work,
                            const IsolationLimits& limits) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw DeviceError("mesh reader", std::string("no pipe: ") + std::strerror(errno),
                      "free file descriptors");
  }
  const pid_t child = fork();
  if (child < 0) {
    const int reason = errno;
    close(ends[0]);
    close(ends[1]);
    throw DeviceError("mesh reader", std::string("no process: ") + std::strerror(reason),
                      "free memory or processes");
  }
  if (child == 0) {
    close(ends[0]);
    run_child(work, limits, ends[1]);
  }
  close(ends[1]);
  IsolatedAnswer answer;
  try {
    answer.failure = collect(ends[0], limits, answer.bytes);
  } catch (const std::bad_alloc&) {
    answer.failure = "gave more data than memory holds";
  }
  close(ends[0]);
  if (!answer.failure.empty()) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (answer.failure.empty()) {
    if (WIFSIGNALED(status)) {
      const int signal = WTERMSIG(status);
      // The kernel sends SIGKILL at the hard processor limit (and when memory runs out).
      answer.failure = signal == SIGXCPU || signal == SIGKILL
                           ? "took too long or too much memory"
                           : "crashed (signal " + std::to_string(signal) + ")";
    } else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      answer.failure = "ended early";
    }
  }
  if (!answer.failure.empty()) answer.bytes.clear();
  return answer;
}

}  // namespace sextant
