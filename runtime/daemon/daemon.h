// SPDX-License-Identifier: Apache-2.0
// The life of sextantd once its parts stand: frames until a signal, the source's end or an error; a report on
// the diagnostics topic now and then.
#pragma once

#include <csignal>
#include <functional>
#include <optional>

#include "runtime/daemon/pipeline.h"
#include "runtime/publish/publisher.h"

namespace sextant {

/// SIGTERM, SIGINT and SIGHUP as something to wait for. Make it before any other thread exists: threads
/// inherit the blocked signals. The destructor restores the mask of its own thread.
class SignalWaiter {
 public:
  SignalWaiter();
  ~SignalWaiter();
  SignalWaiter(const SignalWaiter&) = delete;
  SignalWaiter& operator=(const SignalWaiter&) = delete;
  /// The signal that came, or nothing after the timeout.
  std::optional<int> wait(std::chrono::milliseconds timeout);

 private:
  sigset_t waited_for_{};
  sigset_t old_{};
};

/// What is needed beside the source, the detector and the publisher.
struct DaemonRun {
  PipelineOptions pipeline;
  std::chrono::milliseconds once_wait{
      3000};  ///< with pipeline.once: for a reader, and for its acknowledgement
  std::chrono::milliseconds diagnostics_period{1000};
  std::string hardware_id = "sextantd";  ///< in diagnostics
  /// Called as soon as a signal asks for the end. May be empty.
  std::function<void()> ending{};
  /// Asks a detection that is under way to end soon. May be empty.
  std::function<void()> cancel{};
  /// Called when a signal asks for the end and a detection still runs after 0.7 s: nothing of it will be
  /// published. The daemon leaves the process here; may return in tests.
  std::function<void()> abandon{};
  /// Called on SIGHUP, in another thread: reads the configuration again and says what was done; throws
  /// DoorError and then has changed nothing. May be empty.
  std::function<std::string()> reload{};
  /// Draws the annotated image; called only while someone listens to it. May be empty.
  std::function<cv::Mat(const RgbdFrame&, const FrameResult&)> draw{};
};

/// Runs until a signal, the end of the source, or (once) one frame. Reports to systemd and the log. Throws
/// DeviceError when a device or DDS fails, with `once` also what was wrong with the frame.
void run_daemon(FrameSource& source, const DetectFunction& detect, Publisher& publisher,
                SignalWaiter& signals, const DaemonRun& run);

}  // namespace sextant
