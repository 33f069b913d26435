// SPDX-License-Identifier: Apache-2.0
// From the best lattice pose to the continuous one: Gauss-Newton on depth residuals along the ray, on the
// distances of the model's edges to the image's, and on the contact with the table, with the rigid mesh and
// true perspective (the search's parts are a weak-perspective average over the training distances). Robust
// weights are Tukey's with a gate that narrows (Holland & Welsch 1977). What all pixels of an object share
// (the sensor's warp, the shift between colour and depth) is estimated along with the pose under its prior,
// so that the covariance contains it.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/table_geometry.h"
#include "runtime/model/object_model.h"
#include "runtime/refine/refinement.h"

namespace sextant {

/// What the refinement sees of a frame.
struct RefineFrame {
  const SearchFrame& frame;
  const cv::Mat& edges;                ///< CV_8UC1, edges_by_direction of the frame
  std::optional<TableGeometry> table;  ///< where the object must stand; empty: anywhere
  TableTolerance tolerance;            ///< of that table
};

/// A refined pose.
struct RefinedPose {
  RigidTransform camera_from_object =
      RigidTransform::Identity();  ///< object frame (bounding sphere's centre)
  /// From the sensor's noise alone (see with_model_error), of (x, y, z) of the object frame's origin, metres,
  /// and of (rx, ry, rz), radians, small rotations about the camera's axes applied on the left. About the
  /// axis of a rotational symmetry: uniform over the circle.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  Refinement quality;
};

/// Holds a model's prepared mesh and buffers. One thread at a time.
class Refiner {
 public:
  /// The neighbourhood of a certified lattice pose within which the optimum is looked for.
  static constexpr double kMaxShiftM = 0.03;
  static constexpr double kMaxTurnRad = 0.21;  // 12 deg

  /// Keeps a reference to the model.
  explicit Refiner(const ObjectModel& model);
  ~Refiner();
  Refiner(Refiner&&) noexcept;

  /// Refines one pose of the object frame. Deterministic. Where the mesh has no triangles, where nothing of
  /// it is seen, or where the optimum leaves the neighbourhood, the given pose comes back (quality says so),
  /// with the information there as its covariance.
  RefinedPose refine(const RefineFrame& input, const RigidTransform& camera_from_object);

  /// See picture_comparison.h: how much better the second pose of the object frame explains the depth image.
  double compare(const RefineFrame& input, const RigidTransform& first, const RigidTransform& second);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The covariance of the same pose said for another origin: `offset` is from the old origin to the new one,
/// camera frame, metres (a turn moves the new origin too).
Eigen::Matrix<double, 6, 6> moved_covariance(const Eigen::Matrix<double, 6, 6>& covariance,
                                             const Eigen::Vector3d& offset);

/// The covariance with what the sensor is not to blame for: the mesh is not quite the object (scans, dents),
/// and colour and depth are not calibrated perfectly. On the YCB-Video samples the sensor's share alone
/// is 2.5 to 4 times too small (docs/BENCHMARKS.md). This is what is published.
Eigen::Matrix<double, 6, 6> with_model_error(const Eigen::Matrix<double, 6, 6>& covariance);

}  // namespace sextant
