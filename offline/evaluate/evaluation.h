// SPDX-License-Identifier: Apache-2.0
// How good results are against the ground truth of a data set: per instance, per object, in total.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "offline/dataset/bop_results.h"
#include "offline/evaluate/symmetry_group.h"

namespace sextant {

/// What the evaluation must know of one object.
struct EvaluatedObject {
  SymmetryGroup symmetry;
  Eigen::Vector3d centre_m{0, 0, 0};    ///< point whose distance is the translation error, mesh frame
  Eigen::Vector3d up{0, 0, 1};          ///< axis that points up when it stands, mesh frame
  double diameter_m = 0;                ///< 0: unknown
  std::vector<Eigen::Vector3d> points;  ///< of the mesh; empty: no ADD, no boxes
};

struct EvaluationOptions {
  double max_translation_cm = 1;  ///< a pose within both limits is right
  double max_rotation_deg = 15;
  double min_visible = 0;     ///< instances of a smaller visible fraction are ignored, 0..1
  bool upright_only = false;  ///< ignore instances that do not stand on the table (needs scene_table.json)
  double upright_tolerance_deg = 15;  ///< between the object's up and the table's
};

/// One true object in one image and the detection that was matched to it.
struct InstanceResult {
  int scene_id = 0, image_id = 0, object_id = 0;
  bool found = false;  ///< a detection of this object was matched
  bool right = false;  ///< within the limits
  double score = 0;
  double translation_cm = 0, rotation_deg = 0;  ///< where found
  std::optional<double> add_mm, add_s_mm;       ///< where found and the mesh is known
};

/// Statistics of one object, or of all.
struct ObjectReport {
  std::string name;
  int instances = 0;         ///< true objects that count
  int found = 0;             ///< matched by a detection
  int right = 0;             ///< within both limits
  int detections = 0;        ///< that count (those matched to ignored instances do not)
  int false_images = 0;      ///< images without the object
  int false_detections = 0;  ///< detections on those images
  double median_translation_cm = 0, median_rotation_deg = 0;  ///< over the found ones
  double share_translation = 0, share_rotation = 0;           ///< of all instances, within each limit alone
  std::optional<double> add_recall;         ///< share of all instances with ADD(-S) < 10 % of the diameter
  std::optional<double> average_precision;  ///< 2D boxes with IoU > 0.5

  double share_right() const { return instances > 0 ? static_cast<double>(right) / instances : 0; }
  double recall() const { return share_right(); }
  double precision() const { return detections > 0 ? static_cast<double>(right) / detections : 0; }
};

struct EvaluationReport {
  EvaluationOptions options;
  std::vector<InstanceResult> instances;
  std::map<int, ObjectReport> objects;
  ObjectReport total;
  int images = 0;
  std::optional<double> mean_seconds;  ///< per image with a time
};

/// Per image and object, detections in the order of their scores each take the nearest true object that is
/// still free. Only objects of `objects` are looked at. Throws InputError where results name an image that is
/// not there.
EvaluationReport evaluate(const std::vector<BopImage>& images, const std::vector<BopResult>& results,
                          const std::map<int, EvaluatedObject>& objects, const EvaluationOptions& options,
                          const std::string& results_file = "results");

}  // namespace sextant
