// SPDX-License-Identifier: Apache-2.0
// The chain in one call: frame -> features -> tables -> search -> refine -> result. `sextant detect` and
// `sextantd` both run exactly this.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/detect/region_of_interest.h"
#include "runtime/frame/rgbd_frame.h"
#include "runtime/frame/search_frame.h"
#include "runtime/model/object_model.h"
#include "runtime/refine/frame_result.h"
#include "runtime/search/branch_and_bound.h"
#include "runtime/search/lanes/lane_search.h"

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
  int max_detections = 1;  ///< per object, 1..100
  /// Most places searched and refined per object: while what would be reported is more likely wrong than
  /// right, the next best place is looked at, and the most certain max_detections are reported. Up to
  /// max_detections: no further place is looked at. 1..100
  int candidates = 2;
  std::optional<double> threshold;     ///< log score that a detection must reach; empty: 10 % of the evidence
  double deadline_ms = 0;              ///< for the search of one frame; 0 = none
  int threads = 0;                     ///< of the search; 0 = all cores
  std::string scoring = "likelihood";  ///< see sextant detect --help
  std::string bound = "lanes";         ///< see sextant detect --help
  int search_width = 0;                ///< width of the image that is searched; 0 = the frame's
  bool refine = true;                  ///< from the lattice pose to the continuous one
  double false_positive_rate = 0.1;    ///< wanted share of images with a false detection; 1: report all
  double min_distance_m = 0.35;        ///< nearest object centre searched
  double max_distance_m = 3.0;         ///< farthest
  RegionOfInterest region;             ///< only poses with their centre in it; empty: everywhere
  /// Begins a search with what the last frame's search of the same object found; the answer is the same.
  bool warm_start = true;
  /// Proves how well the best other explanation fits: outside of a ball around every pose that is reported.
  bool runner_up = true;
  double runner_up_radius_m = 0.03;                 ///< of the ball, positions, >= 0
  double runner_up_angle_rad = 0.5235987755982988;  ///< of the ball, orientations, 0..pi (30 deg)
  /// Margins of interest: a larger one is only proven to be at least this. Infinite: all are proven exactly.
  double runner_up_most = 5;
};

/// What the search of one frame read and what it said, for whoever checks it. Valid during the call only.
struct SearchRecord {
  const SearchFrame& frame;
  const cv::Mat& edges;                ///< edges_by_direction
  int clip_radius;                     ///< of the frame's tables, pixels
  std::optional<TableGeometry> table;  ///< empty: no constraint
  TableTolerance tolerance;
  struct Object {
    std::size_t model_index;
    const std::vector<ScoredBin>& bins;
    const Constraint& constraint;
    double threshold;
    SearchOutcome outcome;  ///< empty where nothing was searched (Detector::prepare)
  };
  std::vector<Object> objects;  ///< those that were looked for
};

/// One more place of one model: its best pose beside what was found already.
struct FurtherPlace {
  std::size_t model = 0;    ///< of the detector's models
  double threshold = 0;     ///< log score that the place must reach
  std::vector<Box2> taken;  ///< of what was found, pixels of the searched image
};

/// What may differ from frame to frame.
struct DetectCall {
  /// True: give up soon. What was found so far is returned as kBounded. Asked often, from any
  /// thread.
  std::function<bool()> stop{};
  std::function<bool(const std::string&)> wanted{};  ///< by object name; empty: every object
  std::map<std::string, double> thresholds{};        ///< by object name, instead of the options'
  std::optional<double> deadline_ms{};               ///< instead of the options'; 0: none
  /// Rectangle of the image instead of the options' region.
  std::optional<std::array<double, 4>> image_region{};
  /// Not empty: only these models are looked for, one place of each, without a runner-up, whatever else is
  /// wanted. The detector's own calls for further candidates say this.
  std::vector<FurtherPlace> further{};
  /// Searches in the engine's place (bound "lanes"), for policies such as several processes. The second
  /// argument is what is asked for: this call, or a further one of the detector's own for the same frame.
  std::function<std::vector<SearchOutcome>(const LaneSearchProblem&, const DetectCall&)> search{};
  std::function<void(const SearchRecord&)> searched{};  ///< called once, after the search
};

/// Holds the models and all buffers; one frame at a time.
class Detector {
 public:
  /// Throws InputError / UsageError for options or models that cannot work.
  Detector(std::vector<ObjectModel> models, DetectOptions options);
  ~Detector();
  /// Throws InputError where the frame is unusable (sizes, no table where one is needed).
  FrameResult detect(const RgbdFrame& frame, const DetectCall& call = {});
  /// Everything up to the search, and no search.
  void prepare(const RgbdFrame& frame, const std::function<void(const SearchRecord&)>& visit);
  const std::vector<ObjectModel>& models() const;
  const DetectOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
