// SPDX-License-Identifier: Apache-2.0
// The pose errors of the BOP challenge (Hodan et al., "BOP Challenge 2020 on 6D Object Localization", section
// 2.2) and their recalls: MSSD, MSPD, VSD.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "offline/evaluate/symmetry_group.h"
#include "runtime/geometry/camera_model.h"

namespace sextant {

/// The symmetries as transforms of the mesh frame: rotations about axes through `centre_m`. A continuous one
/// becomes 315 steps: no point of the surface then moves by more than a hundredth of the diameter in one.
std::vector<RigidTransform> symmetry_transforms(const SymmetryGroup& group, const Eigen::Vector3d& centre_m);

/// Maximum symmetry-aware surface distance, metres: over the points the largest distance between the two
/// poses, over the symmetries the smallest of those.
double mssd_m(const std::vector<Eigen::Vector3d>& points, const RigidTransform& estimate,
              const RigidTransform& truth, const std::vector<RigidTransform>& symmetries);

/// Maximum symmetry-aware projection distance, pixels. Infinite where a point is not in front of the camera.
double mspd_px(const std::vector<Eigen::Vector3d>& points, const CameraModel& camera,
               const RigidTransform& estimate, const RigidTransform& truth,
               const std::vector<RigidTransform>& symmetries);

/// Ten thresholds of the challenge: 0.05, 0.10, .. 0.50 (of the diameter for MSSD and for VSD's tolerance
/// tau; VSD's own limits), 5, 10, .. 50 pixels at a width of 640 for MSPD.
inline constexpr int kBopThresholds = 10;
inline double bop_share(int step) { return 0.05 * (step + 1); }
inline double bop_pixels(int step, int image_width) { return 5.0 * (step + 1) * image_width / 640; }

inline constexpr double kVsdDeltaM = 0.015;  ///< tolerance of the visibility test

/// Visible surface discrepancy, one value in 0..1 per tolerance tau = bop_share(i) * diameter. All three
/// images CV_32FC1, distances along the rays in metres, 0 = nothing / missing (which hides nothing).
std::vector<double> vsd(const cv::Mat& estimate_m, const cv::Mat& truth_m, const cv::Mat& measured_m,
                        double diameter_m);

}  // namespace sextant
