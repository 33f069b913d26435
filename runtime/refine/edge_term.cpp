// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/edge_term.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "runtime/refine/edge_match.h"
#include "runtime/refine/sensor_noise.h"

namespace sextant {
namespace {

constexpr double kOccluderM = 0.03;
constexpr double kInlierPx = 2;  // at f = 525
// Of samples laid at random over a cluttered picture, about this share finds an edge of its direction.
constexpr double kChanceShare = 0.2;
constexpr int kFewestMarks = 20;

bool hidden(const SearchFrame& frame, const EdgeSample& s) {
  const int x = static_cast<int>(std::lround(s.pixel.x()));
  const int y = static_cast<int>(std::lround(s.pixel.y()));
  const double observed = frame.ray_depth_m.ptr<float>(y)[x];
  return observed > 0 && observed < s.point.norm() - kOccluderM;
}

}  // namespace

double edge_scale(const PinholeCamera& camera) { return std::max(1.0, camera.focal / 525); }

void add_edge_term(const SearchFrame& frame, const cv::Mat& edges, const std::vector<EdgeSample>& samples,
                   const RigidTransform& pose, double reach_px, NormalEquations& normal,
                   Refinement* quality) {
  const double scale = edge_scale(frame.camera);
  const double reach = reach_px * scale;
  const double sigma = EdgeNoise::kSigmaPx * std::sqrt(scale);
  const double length = EdgeNoise::pixels_per_observation(frame.camera.focal);
  const Eigen::Vector3d centre = pose.translation();
  NormalEquations sum;
  int looked_at = 0;
  int inliers = 0;
  int outline = 0;
  int outline_inliers = 0;
  int marks = 0;
  int mark_inliers = 0;
  double squares = 0;
  for (const EdgeSample& s : samples) {
    if (hidden(frame, s)) continue;
    ++looked_at;
    const bool on_outline = s.origin == EdgeOrigin::kSilhouette;
    const bool on_mark = s.origin == EdgeOrigin::kMark;
    outline += on_outline ? 1 : 0;
    marks += on_mark ? 1 : 0;
    const auto distance = nearest_edge(edges, s.pixel, s.normal, reach);
    if (!distance) continue;
    if (std::abs(*distance) <= kInlierPx * scale) {
      ++inliers;
      outline_inliers += on_outline ? 1 : 0;
      mark_inliers += on_mark ? 1 : 0;
      squares += *distance * *distance;
    }
    const double weight = tukey_weight(*distance / (reach + 0.5));
    if (!(weight > 0)) continue;
    // Change of the image across the edge per metre of shift of the point, and per radian of turn.
    const double over_z = frame.camera.focal / s.point.z();
    const Eigen::Vector3d shift(
        over_z * s.normal.x(), over_z * s.normal.y(),
        -over_z * (s.normal.x() * s.point.x() + s.normal.y() * s.point.y()) / s.point.z());
    const Eigen::Vector3d turn = (s.point - centre).cross(shift);
    sum.add<kPoseUnknowns>({shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z()}, *distance,
                           weight * std::min(1.0, s.spacing_px / length) / (sigma * sigma));
  }
  const double share = inliers / static_cast<double>(std::max(1, looked_at));
  const double trust = std::clamp((share - kChanceShare) / (1 - kChanceShare), 0.05, 1.0);
  normal.add(sum, trust * trust * trust);
  if (!quality) return;
  quality->edge_samples = looked_at;
  quality->edge_inlier_share = share;
  quality->outline_inlier_share = outline_inliers / static_cast<double>(std::max(1, outline));
  quality->mark_inlier_share = marks >= kFewestMarks ? mark_inliers / static_cast<double>(marks) : 0.5;
  quality->edge_rms_px = inliers > 0 ? std::sqrt(squares / inliers) : 0;
}

}  // namespace sextant
