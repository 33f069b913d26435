// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/worker_processes.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <opencv2/core/utility.hpp>
#include <string>

#include "runtime/base/error.h"

namespace sextant {
namespace {

/// Header of a message on the pipe. item kFailure: the payload is an error text.
struct Header {
  std::uint64_t item = 0;
  std::uint64_t size = 0;
};
constexpr std::uint64_t kFailure = std::numeric_limits<std::uint64_t>::max();

bool write_all(int fd, const void* data, std::size_t size) {
  const auto* at = static_cast<const char*>(data);
  while (size > 0) {
    const ssize_t n = write(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

void send(int fd, std::uint64_t item, const void* data, std::size_t size) {
  const Header header{item, size};
  if (!write_all(fd, &header, sizeof header) || !write_all(fd, data, size)) _exit(1);  // the caller is gone
}

[[noreturn]] void be_worker(int fd, pid_t parent, int worker,
                            const std::function<void(int, const Deliver&)>& work) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the caller died before the line above
  cv::setNumThreads(0);               // its threads were not inherited
  try {
    work(worker, [fd](std::size_t item, std::span<const std::byte> bytes) {
      send(fd, item, bytes.data(), bytes.size());
    });
  } catch (const std::exception& e) {
    const std::string what = e.what();
    send(fd, kFailure, what.data(), what.size());
    _exit(1);
  }
  _exit(0);
}

/// The caller's end of one worker: collects bytes until a message is whole.
struct Link {
  pid_t pid = 0;
  int fd = -1;
  std::vector<std::byte> pending;
};

void take_messages(Link& link, const Deliver& receive) {
  std::size_t at = 0;
  while (link.pending.size() - at >= sizeof(Header)) {
    Header header;
    std::copy_n(link.pending.data() + at, sizeof header, reinterpret_cast<std::byte*>(&header));
    if (link.pending.size() - at - sizeof header < header.size) break;
    const std::span<const std::byte> payload(link.pending.data() + at + sizeof header, header.size);
    if (header.item == kFailure) {
      throw InputError("", std::string(reinterpret_cast<const char*>(payload.data()), payload.size()));
    }
    receive(header.item, payload);
    at += sizeof header + header.size;
  }
  link.pending.erase(link.pending.begin(), link.pending.begin() + static_cast<std::ptrdiff_t>(at));
}

/// Kills and reaps what still runs when it goes out of scope.
struct Links {
  std::vector<Link> all;
  ~Links() {
    for (Link& link : all) {
      if (link.fd >= 0) close(link.fd);
      if (link.pid > 0) {
        kill(link.pid, SIGKILL);
        waitpid(link.pid, nullptr, 0);
      }
    }
  }
};

/// Reaps a worker whose pipe has ended.
void finish(Link& link) {
  close(link.fd);
  link.fd = -1;
  int status = 0;
  waitpid(link.pid, &status, 0);
  link.pid = 0;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !link.pending.empty()) {
    throw DeviceError("learning", "a worker process died",
                      "try again; if it stays, render with another driver");
  }
}

}  // namespace

void run_worker_processes(int count, const std::function<void(int worker, const Deliver&)>& work,
                          const Deliver& receive) {
  Links links;
  const pid_t parent = getpid();
  std::fflush(nullptr);
  for (int w = 0; w < count; ++w) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw DeviceError("learning", "no pipe can be made", "close other programs");
    const pid_t pid = fork();
    if (pid < 0) throw DeviceError("learning", "no process can be made", "use fewer --threads");
    if (pid == 0) {
      close(ends[0]);
      for (const Link& other : links.all) close(other.fd);
      be_worker(ends[1], parent, w, work);
    }
    close(ends[1]);
    links.all.push_back({pid, ends[0], {}});
  }
  std::vector<std::byte> buffer(std::size_t{1} << 16);
  while (true) {
    std::vector<pollfd> waiting;
    for (const Link& link : links.all) {
      if (link.fd >= 0) waiting.push_back({link.fd, POLLIN, 0});
    }
    if (waiting.empty()) return;
    if (poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) {
      throw DeviceError("learning", "the worker processes cannot be heard", "try again");
    }
    for (const pollfd& ready : waiting) {
      if (ready.revents == 0) continue;
      for (Link& link : links.all) {
        if (link.fd != ready.fd) continue;
        const ssize_t n = read(link.fd, buffer.data(), buffer.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
          finish(link);
          continue;
        }
        link.pending.insert(link.pending.end(), buffer.begin(), buffer.begin() + n);
        take_messages(link, receive);
      }
    }
  }
}

}  // namespace sextant
