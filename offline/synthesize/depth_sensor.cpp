// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "offline/synthesize/noise_field.h"

namespace sextant {
namespace {

/// Neighbours that differ by more than this (+ this * depth^2) belong to different surfaces.
constexpr double kEdgeStepM = 0.015;

/// Streams of random numbers: switching one effect off leaves the others as they were.
enum Stream : std::uint64_t {
  kShift,
  kJitterX,
  kJitterY,
  kShadow,
  kFine,
  kCoarse,
  kWhite,
  kWarp,
  kLoss,
  kHoles,
  kObjectHoles,
  kObjectShare
};

/// Every pixel takes the depth of a place a little beside it (nearest neighbour: no depths are invented);
/// `lost`, a mask of the same size or empty, goes with it.
cv::Mat displaced(const cv::Mat& depth, cv::Mat& lost, const DepthSensor& sensor, double scale,
                  std::uint64_t seed) {
  Random shift(derived_seed(seed, kShift));
  const double dx = sensor.misregistration_px * scale * shift.normal();
  const double dy = sensor.misregistration_px * scale * shift.normal();
  if (dx == 0 && dy == 0 && sensor.edge_jitter_px == 0) return depth.clone();
  Random random_x(derived_seed(seed, kJitterX));
  Random random_y(derived_seed(seed, kJitterY));
  cv::Mat map_x = smooth_noise(depth.size(), 1.2, random_x) * (sensor.edge_jitter_px * scale);
  cv::Mat map_y = smooth_noise(depth.size(), 1.2, random_y) * (sensor.edge_jitter_px * scale);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      map_x.at<float>(y, x) += static_cast<float>(x + dx);
      map_y.at<float>(y, x) += static_cast<float>(y + dy);
    }
  }
  cv::Mat result;
  cv::remap(depth, result, map_x, map_y, cv::INTER_NEAREST, cv::BORDER_REPLICATE);
  if (!lost.empty()) {
    cv::Mat moved;
    cv::remap(lost, moved, map_x, map_y, cv::INTER_NEAREST, cv::BORDER_REPLICATE);
    lost = moved;
  }
  return result;
}

/// Hides what a second viewpoint, `baseline_px_m` = focal * baseline beside the camera, cannot see: walking
/// away from it, a point is hidden where a nearer one was already projected farther (ordering of
/// disparities).
void cast_shadow(cv::Mat& missing, const cv::Mat& depth, double baseline_px_m, bool to_the_left,
                 Random& random) {
  if (baseline_px_m <= 0) return;
  for (int y = 0; y < depth.rows; ++y) {
    const double b = baseline_px_m * (1 + 0.06 * random.normal());
    double front = std::numeric_limits<double>::infinity();
    for (int i = 0; i < depth.cols; ++i) {
      const int x = to_the_left ? depth.cols - 1 - i : i;
      const float z = depth.at<float>(y, x);
      if (z <= 0) continue;
      const double projected = (to_the_left ? x : -x) - b / z;
      if (projected > front + 0.05) {
        missing.at<unsigned char>(y, x) = 255;
      } else {
        front = std::min(front, projected);
      }
    }
  }
}

/// 255 where a neighbour lies on another surface.
cv::Mat depth_edges(const cv::Mat& depth) {
  cv::Mat low;
  cv::Mat high;
  cv::erode(depth, low, cv::Mat());
  cv::dilate(depth, high, cv::Mat());
  cv::Mat edges;
  cv::compare(high - low, (high.mul(high) + 1) * kEdgeStepM, edges, cv::CMP_GT);
  return edges;
}

void lose_edges(cv::Mat& missing, const cv::Mat& depth, double loss_px, std::uint64_t seed) {
  if (loss_px <= 0) return;
  // Distance to the edge compared with a random reach: ragged seams of about loss_px, here and there none.
  cv::Mat distance;
  cv::distanceTransform(255 - depth_edges(depth), distance, cv::DIST_L2, cv::DIST_MASK_5);
  Random random(derived_seed(seed, kLoss));
  const cv::Mat reach = (smooth_noise(depth.size(), std::max(2.0, loss_px), random) * 0.7 + 0.5) * loss_px;
  missing.setTo(255, distance < reach);
}

/// Threshold that a standard normal value exceeds with this probability.
double normal_quantile_above(double probability) {
  double lo = -8;
  double hi = 8;
  for (int i = 0; i < 60; ++i) {
    const double middle = (lo + hi) / 2;
    (0.5 * std::erfc(middle / std::sqrt(2.0)) > probability ? lo : hi) = middle;
  }
  return lo;
}

void lose_blobs(cv::Mat& missing, double share, std::uint64_t seed) {
  if (share <= 0) return;
  Random random(derived_seed(seed, kHoles));
  const cv::Mat field = smooth_noise(missing.size(), 2.0, random);
  missing.setTo(255, field > normal_quantile_above(share));
}

/// Mask of what dark, shiny or steep objects lose; empty without objects.
cv::Mat object_holes(const DepthSurfaces& surfaces, const DepthSensor& sensor, double scale,
                     std::uint64_t seed) {
  if (surfaces.object.empty() || (sensor.object_hole_hi <= 0 && surfaces.no_depth.empty())) return {};
  Random random(derived_seed(seed, kObjectHoles));
  const cv::Mat field = smooth_noise(surfaces.object.size(), 3.0 * scale, random);
  std::map<int, double> threshold;
  const auto threshold_of = [&](int object) {
    const auto [it, fresh] = threshold.try_emplace(object, 0);
    if (!fresh) return it->second;
    Random own(derived_seed(seed, kObjectShare * 100000 + static_cast<std::uint64_t>(object)));
    double share = own.uniform(sensor.object_hole_lo, sensor.object_hole_hi);
    if (std::count(surfaces.no_depth.begin(), surfaces.no_depth.end(), object) > 0)
      share = own.uniform(0.9, 1);
    it->second = share > 0 ? normal_quantile_above(share) : 100;
    return it->second;
  };
  cv::Mat lost(surfaces.object.size(), CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < lost.rows; ++y) {
    for (int x = 0; x < lost.cols; ++x) {
      const int object = surfaces.object.at<std::int16_t>(y, x);
      if (object >= 0 && field.at<float>(y, x) > threshold_of(object)) lost.at<unsigned char>(y, x) = 255;
    }
  }
  return lost;
}

/// Noise in units of the fast rms with the sensor's mix of correlation lengths.
cv::Mat fast_field(const cv::Size& size, const DepthSensor& sensor, double scale, std::uint64_t seed) {
  Random fine(derived_seed(seed, kFine));
  Random coarse(derived_seed(seed, kCoarse));
  Random white(derived_seed(seed, kWhite));
  cv::Mat field = smooth_noise(size, sensor.fine_sigma_px * scale, fine) * std::sqrt(sensor.fine_share);
  field += smooth_noise(size, sensor.coarse_sigma_px * scale, coarse) * std::sqrt(sensor.coarse_share);
  field += white_noise(size, white) * std::sqrt(sensor.white_share);
  return field;
}

double quantised(double z_m, const DepthSensor& sensor) {
  if (sensor.quantisation_per_m > 0)
    z_m = 1 / (std::round(1 / z_m / sensor.quantisation_per_m) * sensor.quantisation_per_m);
  if (sensor.round_mm > 0) z_m = std::round(z_m * 1000 / sensor.round_mm) * sensor.round_mm / 1000;
  return z_m;
}

}  // namespace

double DepthTable::at(double depth_m) const {
  if (rows.empty()) return 0;
  const auto scaled = [&](const Row& row) { return row.value_mm * std::pow(depth_m / row.depth_m, 2); };
  if (depth_m <= rows.front().depth_m) return scaled(rows.front());
  if (depth_m >= rows.back().depth_m) return scaled(rows.back());
  const auto above = std::upper_bound(rows.begin(), rows.end(), depth_m,
                                      [](double d, const Row& row) { return d < row.depth_m; });
  const Row& a = *(above - 1);
  return a.value_mm + (above->value_mm - a.value_mm) * (depth_m - a.depth_m) / (above->depth_m - a.depth_m);
}

cv::Mat apply_depth_sensor(const cv::Mat& axial_depth_m, double focal_px, const DepthSensor& sensor,
                           std::uint64_t seed, const DepthSurfaces& surfaces) {
  const double scale = focal_px / sensor.focal_px;
  cv::Mat lost = object_holes(surfaces, sensor, scale, seed);
  const cv::Mat depth = displaced(axial_depth_m, lost, sensor, scale, seed);
  cv::Mat missing(depth.size(), CV_8UC1, cv::Scalar(0));
  if (!lost.empty()) missing.setTo(255, lost);
  Random shadow(derived_seed(seed, kShadow));
  cast_shadow(missing, depth, sensor.shadow_left_m * focal_px, true, shadow);
  cast_shadow(missing, depth, sensor.shadow_right_m * focal_px, false, shadow);
  lose_edges(missing, depth, sensor.edge_loss_px * scale, seed);
  lose_blobs(missing, sensor.hole_share, seed);

  const cv::Mat fast = fast_field(depth.size(), sensor, scale, seed);
  Random warp_random(derived_seed(seed, kWarp));
  const cv::Mat warp = smooth_noise(depth.size(), sensor.warp_sigma_px * scale, warp_random);
  cv::Mat result(depth.size(), CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double z = depth.at<float>(y, x);
      if (!(z > 0) || z < sensor.nearest_m || z > sensor.farthest_m || missing.at<unsigned char>(y, x))
        continue;
      const double fast_mm = sensor.fast_noise.at(z);
      const double slow_mm = sensor.slow_warp.at(z);
      const double warp_mm =
          std::sqrt(std::max(0.0, slow_mm * slow_mm - sensor.coarse_in_slow * fast_mm * fast_mm));
      const double noisy = z + (fast_mm * fast.at<float>(y, x) + warp_mm * warp.at<float>(y, x)) / 1000;
      if (noisy > 0.01) result.at<float>(y, x) = static_cast<float>(quantised(noisy, sensor));
    }
  }
  return result;
}

}  // namespace sextant
