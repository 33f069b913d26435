// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/depth_term.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "runtime/refine/sensor_noise.h"

namespace sextant {
namespace {

// Neighbours share their noise (DepthNoise::pixels_per_observation): more samples would say nothing new.
constexpr double kWantedSamples = 700;
// A surface seen more flatly than this (cosine) says little about its distance and much about jitter.
constexpr double kFlattest = 0.17;
// Depth this much nearer than the surface belongs to something in front of it.
constexpr double kOccluderM = 0.015;
constexpr double kClosestInlierM = 0.006;

int sample_step(const cv::Rect& window) {
  // About 0.6 of its window is covered by an object's picture.
  return std::max(1, static_cast<int>(std::sqrt(0.6 * window.area() / kWantedSamples)));
}

/// Away from background by two pixels.
bool is_inside(const DepthRaster& raster, int x, int y) {
  return raster.triangle(x - 2, y) != DepthRaster::kBackground &&
         raster.triangle(x + 2, y) != DepthRaster::kBackground &&
         raster.triangle(x, y - 2) != DepthRaster::kBackground &&
         raster.triangle(x, y + 2) != DepthRaster::kBackground;
}

/// Where the pixels went.
struct Counts {
  int inliers = 0, off_surface = 0, occluded = 0, missing = 0;
  double squares = 0;

  void add(double residual, double sigma) {
    const double limit = std::max(kClosestInlierM, 3 * sigma);
    if (std::abs(residual) <= limit) {
      ++inliers;
      squares += residual * residual;
    } else if (residual < -std::max(limit, kOccluderM)) {
      ++occluded;
    } else {
      ++off_surface;
    }
  }

  void fill(Refinement& quality) const {
    quality.depth_samples = inliers + off_surface + occluded + missing;
    const double n = std::max(1, quality.depth_samples);
    quality.depth_inlier_share = inliers / n;
    quality.off_surface_share = off_surface / n;
    quality.occluded_share = occluded / n;
    quality.missing_share = missing / n;
    quality.depth_rms_m = inliers > 0 ? std::sqrt(squares / inliers) : 0;
  }
};

}  // namespace

void add_depth_term(const SearchFrame& frame, const DepthRaster& raster,
                    const std::vector<Eigen::Vector3f>& face_normals, const RigidTransform& pose,
                    const Shared& shared, double gate_m, NormalEquations& normal, Refinement* quality) {
  const PinholeCamera& camera = frame.camera;
  const Eigen::Vector3d centre = pose.translation();
  const Eigen::Vector2d middle(centre.x() / centre.z(), centre.y() / centre.z());
  const Eigen::Matrix3d rotation = pose.linear();
  const cv::Rect window = raster.window();
  const int step = sample_step(window);
  const double pixel_share = std::min(1.0, step * step / DepthNoise::pixels_per_observation(camera.focal));
  Counts counts;
  for (int y = window.y + step / 2; y < window.y + window.height; y += step) {
    const auto* observed = frame.ray_depth_m.ptr<float>(y);
    for (int x = window.x + step / 2; x < window.x + window.width; x += step) {
      const std::int32_t face = raster.triangle(x, y);
      if (face == DepthRaster::kBackground || !is_inside(raster, x, y)) continue;
      if (!(observed[x] > 0)) {
        ++counts.missing;
        continue;
      }
      const double axial = 1 / static_cast<double>(raster.inverse_depth(x, y));
      const Eigen::Vector2d tangent = camera.tangent(x, y);
      const double stretch = std::sqrt(1 + tangent.squaredNorm());
      const Eigen::Vector3d point(tangent.x() * axial, tangent.y() * axial, axial);
      const double z = axial * stretch;
      const Eigen::Vector3d n = rotation * face_normals[static_cast<std::size_t>(face)].cast<double>();
      const double cosine = n.dot(point) / z;
      if (std::abs(cosine) < kFlattest) continue;
      // Change of the ray's depth per metre of shift of the surface, and per radian of turn.
      const Eigen::Vector3d shift = n / cosine;
      const Eigen::Vector3d turn = (point - centre).cross(shift);
      const std::array<double, kUnknowns> row{shift.x(),
                                              shift.y(),
                                              shift.z(),
                                              turn.x(),
                                              turn.y(),
                                              turn.z(),
                                              1,
                                              tangent.x() - middle.x(),
                                              tangent.y() - middle.y(),
                                              shift.x() * axial,
                                              shift.y() * axial};
      double residual = static_cast<double>(observed[x]) - z;
      for (std::size_t i = 0; i < kSharedUnknowns; ++i) {
        residual -= row[kPoseUnknowns + i] * shared[static_cast<Eigen::Index>(i)];
      }
      // A pixel sees a surface's edge-on slope through half a pixel of jitter.
      const double flat = std::sqrt(std::max(0.0, 1 - cosine * cosine)) / std::abs(cosine);
      const double jitter = 0.5 * axial / camera.focal * flat;
      const double surface = DepthNoise::kSurfaceM / std::abs(cosine);
      const double fast = DepthNoise::fast_m(z);
      const double variance = fast * fast + surface * surface + jitter * jitter;
      const double sigma = std::sqrt(variance);
      if (quality) counts.add(residual, sigma);
      const double weight = tukey_weight(residual / std::max(gate_m, 4 * sigma));
      if (weight > 0) normal.add<kUnknowns>(row, residual, weight * pixel_share / variance);
    }
  }
  if (quality) counts.fill(*quality);
}

}  // namespace sextant
