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
#include "offline/evaluate/calibration.h"
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
  double strict_translation_cm = 0.5;  ///< a second, stricter pair of limits
  double strict_rotation_deg = 5;
  int image_width = 640;      ///< pixels; scales the limits of MSPD
  double min_visible = 0;     ///< instances of a smaller visible fraction are ignored, 0..1
  bool upright_only = false;  ///< ignore instances that do not stand on the table (needs scene_table.json)
  double upright_tolerance_deg = 15;  ///< between the object's up and the table's
};

/// One true object in one image and the detection that was matched to it.
struct InstanceResult {
  int scene_id = 0, image_id = 0, object_id = 0;
  bool found = false;   ///< a detection of this object was matched
  bool right = false;   ///< within the limits
  bool strict = false;  ///< within the strict ones
  double score = 0;
  double visible = 1;                           ///< fraction of the true object, 1 where it is not known
  double translation_cm = 0, rotation_deg = 0;  ///< where found
  std::optional<double> add_mm, add_s_mm;       ///< where found and the mesh is known
  std::optional<double> mssd_mm, mspd_px;       ///< the same
  std::optional<double> turntable_deg;  ///< signed error about the object's up, where found and it is defined
  std::vector<double> vsd;              ///< per tolerance; empty: not measured
  RigidTransform truth = RigidTransform::Identity();     ///< camera_from_mesh
  RigidTransform estimate = RigidTransform::Identity();  ///< camera_from_mesh, where found
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
  int strict = 0;                           ///< within both strict limits
  std::optional<double> ar_mssd, ar_mspd, ar_vsd;  ///< mean recall over BOP's thresholds
  std::vector<PrecisionRecall> curve;              ///< of the boxes
  std::optional<Calibration> calibrated;           ///< of the scores, where they are probabilities

  double share_right() const { return instances > 0 ? static_cast<double>(right) / instances : 0; }
  double share_strict() const { return instances > 0 ? static_cast<double>(strict) / instances : 0; }
  double recall() const { return share_right(); }
  /// BOP's average recall: the mean of the three.
  std::optional<double> average_recall() const {
    if (!ar_mssd || !ar_mspd || !ar_vsd) return std::nullopt;
    return (*ar_mssd + *ar_mspd + *ar_vsd) / 3;
  }
  double precision() const { return detections > 0 ? static_cast<double>(right) / detections : 0; }
};

/// A detection that no true object of its kind was left for.
struct FalseAnswer {
  int scene_id = 0, image_id = 0, object_id = 0;
  double score = 0;
  RigidTransform estimate = RigidTransform::Identity();  ///< camera_from_mesh
};

/// Which detectors answer where an object stands (thesis tables 6.5 and 6.6).
struct Confusion {
  std::map<int, int> images;  ///< by actual object: images that hold it
  /// By actual, then predicted object: images with such a detection anywhere / inside the actual object's
  /// box. On the diagonal: a box with IoU > 0.5; off it: a detection that is on no true object of its kind.
  std::map<int, std::map<int, int>> anywhere, inside;
};

struct EvaluationReport {
  EvaluationOptions options;
  std::vector<InstanceResult> instances;
  std::vector<FalseAnswer> false_answers;
  std::map<int, ObjectReport> objects;
  ObjectReport total;
  int images = 0;
  std::optional<double> mean_seconds;  ///< per image with a time
  std::vector<double> seconds;         ///< of those images
  Confusion confusion;
};

/// Mean over BOP's thresholds of the share of instances below them, from what the instances hold: MSSD
/// (limits are shares of diameter_m), MSPD (pixels). VSD: over tolerances and limits.
double recall_mssd(const std::vector<const InstanceResult*>& instances,
                   const std::map<int, EvaluatedObject>& objects);
double recall_mspd(const std::vector<const InstanceResult*>& instances, int image_width);
double recall_vsd(const std::vector<const InstanceResult*>& instances);

/// Per image and object, detections in the order of their scores each take the nearest true object that is
/// still free. Only objects of `objects` are looked at. Throws InputError where results name an image that is
/// not there.
EvaluationReport evaluate(const std::vector<BopImage>& images, const std::vector<BopResult>& results,
                          const std::map<int, EvaluatedObject>& objects, const EvaluationOptions& options,
                          const std::string& results_file = "results");

}  // namespace sextant
