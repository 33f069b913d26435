// SPDX-License-Identifier: Apache-2.0
// The chain in one call: frame -> features -> tables -> search -> refine -> result. `sextant detect` and
// `sextantd` both run exactly this.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/model/object_model.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// Where the table constraint comes from.
enum class TableSource {
  kNone,      ///< no constraint: every bin of the model, everywhere
  kFrame,     ///< the frame's own (scene_table.json, the source); an error where it has none
  kEstimate,  ///< fitted to the depth image
  kFixed,     ///< DetectOptions::fixed_table
};

/// Options of detection. Every field has its unit in the name.
struct DetectOptions {
  TableSource table = TableSource::kFrame;
  TableGeometry fixed_table;
  TableTolerance tolerance;
  int max_detections = 1;              ///< per object, 1..100
  std::optional<double> threshold;     ///< log score that a detection must reach; empty: 15 % of the evidence
  double deadline_ms = 0;              ///< for the search of one frame; 0 = none
  int threads = 0;                     ///< of the search; 0 = all cores
  std::string scoring = "likelihood";  ///< see sextant detect --help
  std::string bound = "lanes";         ///< see sextant detect --help
  int search_width = 0;                ///< width of the image that is searched; 0 = the frame's
  bool refine = true;                  ///< from the lattice pose to the continuous one
  double false_positive_rate = 0.1;    ///< wanted share of images with a false detection; 1: report all
  double min_distance_m = 0.35;        ///< nearest object centre searched
  double max_distance_m = 3.0;         ///< farthest
};

/// What may differ from frame to frame.
struct DetectCall {
  /// True: give up soon. What was found so far is returned as kBounded. Asked often, from any
  /// thread.
  std::function<bool()> stop{};
  std::function<bool(const std::string&)> wanted{};  ///< by object name; empty: every object
  std::map<std::string, double> thresholds{};        ///< by object name, instead of the options'
  std::optional<double> deadline_ms{};               ///< instead of the options'; 0: none
};

/// Holds the models and all buffers; one frame at a time.
class Detector {
 public:
  /// Throws InputError / UsageError for options or models that cannot work.
  Detector(std::vector<ObjectModel> models, DetectOptions options);
  ~Detector();
  /// Throws InputError where the frame is unusable (sizes, no table where one is needed).
  FrameResult detect(const RgbdFrame& frame, const DetectCall& call = {});
  const std::vector<ObjectModel>& models() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
