// SPDX-License-Identifier: Apache-2.0
// What is looked for, and how, while frames pass: detection on one thread, commands that change it on
// another. A change holds from the next frame on; one that fails changes nothing.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "runtime/daemon/model_store.h"
#include "runtime/detect/detector.h"
#include "runtime/publish/command.h"

namespace sextant {

/// All that a configuration says about detection.
struct DetectionSetup {
  std::vector<LoadedModel> models;
  DetectOptions options;
  std::vector<std::filesystem::path> model_folders;  ///< from which commands may load
  double max_look_age_ms = 600'000;                  ///< from capture to the answer of a look
};

/// Told of every frame before it is searched, on the thread that detects: lets others search it too, by
/// `call.search`. `call` says what is looked for; a changed detector is another object.
using SearchElsewhere = std::function<void(
    const RgbdFrame& frame, const std::shared_ptr<const Detector>& detector, DetectCall& call)>;

class DetectionService {
 public:
  using Clock = std::chrono::steady_clock;
  /// Told about every change of the models, from the thread that made it.
  using ModelsChanged = std::function<void(const std::vector<ObjectModel>&)>;

  /// Throws as Detector does; a setup without models finds nothing.
  explicit DetectionService(DetectionSetup setup, ModelsChanged models_changed = {},
                            SearchElsewhere search_elsewhere = {});
  ~DetectionService();
  DetectionService(const DetectionService&) = delete;
  DetectionService& operator=(const DetectionService&) = delete;

  /// Poses of the enabled objects. Looks that wait are answered here, with the first frame that was captured
  /// after them. Throws as Detector does. One thread.
  FrameResult detect(const RgbdFrame& frame);
  /// The detection under way ends soon, and all later ones find nothing. From any thread.
  void cancel();

  /// Does everything but kLook and kReload, and says what became of it.
  CommandAnswer execute(const Command& command);
  /// Answers later: from detect(), or from expire_looks() when no frame came within the patience. A result
  /// that is older than max_look_age_ms is kFailed, never given out as fresh.
  void look(const Command& command, std::function<void(const CommandAnswer&)> answer,
            std::chrono::milliseconds patience, Clock::time_point now = Clock::now());
  void expire_looks(Clock::time_point now = Clock::now());

  /// Another configuration, as if begun with it: what commands had changed is forgotten. Throws without a
  /// change.
  void replace(DetectionSetup setup);

  /// An answer with what holds now; the rest is the caller's.
  CommandAnswer answer_to(const Command& command, CommandResult result, std::string message) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
