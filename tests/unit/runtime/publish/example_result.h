// SPDX-License-Identifier: Apache-2.0
// Random but valid results.
#pragma once

#include <Eigen/Geometry>
#include <random>

#include "runtime/refine/frame_result.h"

namespace sextant {

inline FrameResult random_result(unsigned seed, int poses) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  FrameResult result;
  result.captured_at =
      CaptureTime(std::chrono::nanoseconds(1'700'000'000'123'456'789 + static_cast<int>(seed)));
  result.frame_id = "camera_color_optical_frame";
  result.sequence = 41 + seed;
  result.nodes = 123456789012345ULL + seed;
  result.seconds.total = unit(random);
  for (int i = 0; i < poses; ++i) {
    PoseEstimate e;
    e.object_id = i + 1;
    e.object_name = "object_" + std::to_string(i);
    Eigen::Vector4d q(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
    e.camera_from_object.linear() = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
    e.camera_from_object.translation() = Eigen::Vector3d(unit(random), unit(random), 0.5 + unit(random));
    Eigen::Matrix<double, 6, 6> half;
    for (double& d : half.reshaped()) d = unit(random) * 0.01;
    e.covariance = half * half.transpose();
    e.score = unit(random);
    e.log_score = -10 * unit(random);
    e.upper_bound = e.log_score + unit(random);
    e.gap = e.upper_bound - e.log_score;
    e.runner_up_margin = unit(random);
    e.status = i % 2 == 0 ? SearchStatus::kOptimal : SearchStatus::kBounded;
    e.bbox = {100 * unit(random), 100 * unit(random), 50 * unit(random), 50 * unit(random)};
    result.estimates.push_back(e);
    result.objects.push_back({0, e.object_id, e.object_name, e.status, e.upper_bound, -12.5, unit(random)});
  }
  result.objects.push_back({0, 99, "missing", SearchStatus::kAbsent, -30.25, -12.5, 1});
  result.table = TableGeometry::from_pitch_roll(0.6, -0.1, 0.75);
  result.table_origin = TableProvenance::kEstimate;
  return result;
}

}  // namespace sextant
