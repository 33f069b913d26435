// SPDX-License-Identifier: Apache-2.0
// Poses from DDS, as `sextant echo` prints them: a best-effort reader that checks what it gets.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "runtime/publish/publisher.h"
#include "runtime/publish/topics.h"

namespace sextant {

/// What to listen to.
struct EchoReaderOptions {
  unsigned domain = 0;                   ///< 0..230
  std::string topic = "pose_estimates";  ///< with its namespace, e.g. "arm/pose_estimates"
  TopicKind kind = TopicKind::kPoseEstimates;
};

/// One message that passed the checks.
struct EchoMessage {
  std::string text;  ///< for people, one or more lines, printable ASCII
  std::string json;  ///< for programs, one line
};

/// A participant with one reader. Messages that nobody should act on are reported through `warn`, as are
/// publishers that vanish or offer too little.
class EchoReader {
 public:
  /// Throws UsageError for impossible names, DeviceError where DDS cannot start.
  EchoReader(const EchoReaderOptions& options, std::function<void(const EchoMessage&)> receive,
             WarnFunction warn = {});
  ~EchoReader();
  EchoReader(const EchoReader&) = delete;
  EchoReader& operator=(const EchoReader&) = delete;

  /// Waits for messages up to the timeout and hands over at most `most`, oldest first. Returns their number.
  int poll(std::chrono::milliseconds timeout, int most = 100);
  /// Writers that match at this moment.
  int matched_writers() const;
  /// Messages that were refused so far.
  std::uint64_t refused() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
