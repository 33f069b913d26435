// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/depth_outline.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "runtime/refine/edge_term.h"
#include "runtime/refine/sensor_noise.h"

namespace sextant {
namespace {

constexpr double kFartherM = 0.025;
constexpr double kOnSurfaceM = 0.012;
constexpr int kWidestGapPx = 3;
// Depth cameras find outlines less well than their colour cameras, and wrongly along whole sides.
constexpr double kSigmaPx = 2;
constexpr double kPixelsPerObservation = 16;  // at f = 525

enum class Seen : std::uint8_t { kNothing, kSurface, kBehind, kInFront };

Seen seen_at(const SearchFrame& frame, const DepthRaster& raster, const EdgeSample& sample,
             const Eigen::Vector2d& at) {
  const int x = static_cast<int>(std::lround(at.x()));
  const int y = static_cast<int>(std::lround(at.y()));
  if (x < 0 || y < 0 || x >= frame.ray_depth_m.cols || y >= frame.ray_depth_m.rows) return Seen::kNothing;
  const double observed = frame.ray_depth_m.ptr<float>(y)[x];
  if (!(observed > 0)) return Seen::kNothing;
  // Beyond the outline the surface is thought to go on at its depth there.
  const double inverse = raster.inverse_depth(x, y);
  const double stretch = std::sqrt(1 + frame.camera.tangent(x, y).squaredNorm());
  const double surface = inverse > 0 ? stretch / inverse : sample.point.norm();
  const double tolerance = std::max(kOnSurfaceM, 3 * DepthNoise::fast_m(surface));
  if (observed < surface - tolerance) return Seen::kInFront;
  if (observed <= surface + tolerance) return Seen::kSurface;
  return observed >= surface + std::max(kFartherM, 2 * tolerance) ? Seen::kBehind : Seen::kNothing;
}

}  // namespace

std::optional<double> depth_outline_at(const SearchFrame& frame, const DepthRaster& raster,
                                       const EdgeSample& sample, double reach) {
  const auto covered = [&](double s) {
    const Eigen::Vector2d p = sample.pixel + s * sample.normal;
    return raster.triangle(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))) !=
           DepthRaster::kBackground;
  };
  if (covered(2) == covered(-2)) return std::nullopt;
  const double outward = covered(2) ? -1 : 1;
  const int far = static_cast<int>(reach);
  std::optional<double> best;
  int last_on = -far - 10;  // the last pixel of the surface
  for (int t = -far; t <= far; ++t) {
    const Seen seen = seen_at(frame, raster, sample, sample.pixel + t * outward * sample.normal);
    if (seen == Seen::kInFront) {
      if (t > 0) break;
      best.reset();
      last_on = -far - 10;
    } else if (seen == Seen::kSurface) {
      last_on = t;
    } else if (seen == Seen::kBehind && t - last_on <= kWidestGapPx + 1) {
      const double end = 0.5 * (last_on + t);
      if (!best || std::abs(end) < std::abs(*best)) best = end;
      last_on = -far - 10;
    }
  }
  if (!best) return std::nullopt;
  return outward * *best;
}

void add_depth_outline_term(const SearchFrame& frame, const DepthRaster& raster,
                            const std::vector<EdgeSample>& samples, const RigidTransform& pose,
                            const Shared& shared, double reach_px, NormalEquations& normal) {
  const double focal = frame.camera.focal;
  const double scale = edge_scale(frame.camera);
  const double reach = reach_px * scale;
  const double information = 1 / (kSigmaPx * kSigmaPx * scale * scale);
  const Eigen::Vector3d centre = pose.translation();
  const Eigen::Vector2d depth_shift = shared.tail<2>();
  for (const EdgeSample& s : samples) {
    if (s.origin != EdgeOrigin::kSilhouette) continue;
    const auto distance = depth_outline_at(frame, raster, s, reach);
    if (!distance) continue;
    const double residual = *distance - focal * s.normal.dot(depth_shift);
    const double weight = tukey_weight(residual / (reach + 0.5 * scale));
    if (!(weight > 0)) continue;
    // Change of the outline across its direction per metre of shift of the point, and per radian of turn.
    const double over_z = focal / s.point.z();
    const Eigen::Vector3d shift(
        over_z * s.normal.x(), over_z * s.normal.y(),
        -over_z * (s.normal.x() * s.point.x() + s.normal.y() * s.point.y()) / s.point.z());
    const Eigen::Vector3d turn = (s.point - centre).cross(shift);
    normal.add<kUnknowns>(
        {shift.x(), shift.y(), shift.z(), turn.x(), turn.y(), turn.z(), 0, 0, 0, focal * s.normal.x(),
         focal * s.normal.y()},
        residual, weight * information * std::min(1.0, s.spacing_px / (kPixelsPerObservation * scale)));
  }
}

}  // namespace sextant
