// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/search_frame.h"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>

#include "runtime/base/error.h"

namespace sextant {
namespace {

void check(const RgbdFrame& frame) {
  const std::string where = "frame " + std::to_string(frame.sequence);
  frame.camera.check(where);
  if (frame.colour.type() != CV_8UC3 || frame.axial_depth_m.type() != CV_32FC1) {
    throw InputError(where, "colour must be 8-bit RGB and depth 32-bit metres", "check the source's formats");
  }
  const cv::Size size(frame.camera.width, frame.camera.height);
  if (frame.colour.size() != size || frame.axial_depth_m.size() != size) {
    throw InputError(where,
                     "the images are " + std::to_string(frame.colour.cols) + " x " +
                         std::to_string(frame.colour.rows) + " and " +
                         std::to_string(frame.axial_depth_m.cols) + " x " +
                         std::to_string(frame.axial_depth_m.rows) + ", the calibration is for " +
                         std::to_string(size.width) + " x " + std::to_string(size.height),
                     "register depth to colour and give the calibration of that size");
  }
}

/// For each ideal pixel, the pixel of the source image that sees the same ray.
cv::Mat source_pixels(const CameraModel& source, const PinholeCamera& ideal) {
  cv::Mat map(ideal.height, ideal.width, CV_32FC2);
  for (int y = 0; y < ideal.height; ++y) {
    auto* row = map.ptr<cv::Vec2f>(y);
    for (int x = 0; x < ideal.width; ++x) {
      const Eigen::Vector2d p = source.distorted_pixel(ideal.tangent(x, y));
      row[x] = {static_cast<float>(p.x()), static_cast<float>(p.y())};
    }
  }
  return map;
}

/// Pixels of an image as pixels of the same image resized to `to`.
cv::Mat in_resized(const cv::Mat& pixels, cv::Size from, cv::Size to) {
  const cv::Vec2d scale(static_cast<double>(to.width) / from.width,
                        static_cast<double>(to.height) / from.height);
  cv::Mat out(pixels.size(), CV_32FC2);
  for (int y = 0; y < pixels.rows; ++y) {
    const auto* in = pixels.ptr<cv::Vec2f>(y);
    auto* row = out.ptr<cv::Vec2f>(y);
    for (int x = 0; x < pixels.cols; ++x) {
      for (int k = 0; k < 2; ++k) row[x][k] = static_cast<float>((in[x][k] + 0.5) * scale[k] - 0.5);
    }
  }
  return out;
}

cv::Mat ray_from_axial(const PinholeCamera& camera) {
  cv::Mat factor(camera.height, camera.width, CV_32FC1);
  for (int y = 0; y < camera.height; ++y) {
    auto* row = factor.ptr<float>(y);
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d t = camera.tangent(x, y);
      row[x] = static_cast<float>(std::sqrt(1 + t.squaredNorm()));
    }
  }
  return factor;
}

/// depth * factor, 0 where it is missing.
cv::Mat scaled(const cv::Mat& depth, const cv::Mat& factor) {
  cv::Mat out(depth.size(), CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    const auto* in = depth.ptr<float>(y);
    const auto* scale = factor.ptr<float>(y);
    auto* __restrict row = out.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      // Written so that a NaN is missing.
      const bool usable = (in[x] > 0) & (in[x] < std::numeric_limits<float>::max());
      row[x] = usable ? in[x] * scale[x] : 0.0F;
    }
  }
  return out;
}

bool same(const CameraModel& a, const CameraModel& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
         a.cy == b.cy && a.distortion == b.distortion;
}

}  // namespace

void Rectifier::prepare(const CameraModel& source) {
  if (same(source, source_)) return;
  source_ = source;
  ideal_ = source.ideal(width_out_);
  ray_from_axial_ = ray_from_axial(ideal_);
  as_is_ = source.is_ideal() && ideal_.width == source.width;
  if (as_is_) return;
  const cv::Mat map = source_pixels(source, ideal_);
  cv::convertMaps(map, cv::Mat(), depth_pixels_, cv::noArray(), CV_16SC2, true);
  // Below three quarters of the size, interpolation alone would skip source pixels.
  shrinks_ = 4 * ideal_.width <= 3 * source.width;
  const cv::Mat colour_map =
      shrinks_ ? in_resized(map, {source.width, source.height}, {ideal_.width, ideal_.height}) : map;
  cv::convertMaps(colour_map, cv::Mat(), colour_pixels_, colour_fractions_, CV_16SC2);
}

cv::Mat Rectifier::rectified_colour(const CameraModel& camera, const cv::Mat& colour) {
  prepare(camera);
  if (as_is_) return colour;
  cv::Mat source = colour;
  if (shrinks_) cv::resize(colour, source, {ideal_.width, ideal_.height}, 0, 0, cv::INTER_AREA);
  cv::Mat out;
  cv::remap(source, out, colour_pixels_, colour_fractions_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

SearchFrame Rectifier::rectified(const RgbdFrame& frame) {
  check(frame);
  prepare(frame.camera);
  SearchFrame out;
  out.camera = ideal_;
  out.colour = rectified_colour(frame.camera, frame.colour);
  cv::Mat moved;
  if (!as_is_) {
    cv::remap(frame.axial_depth_m, moved, depth_pixels_, cv::Mat(), cv::INTER_NEAREST, cv::BORDER_CONSTANT,
              0);
  }
  out.ray_depth_m = scaled(as_is_ ? frame.axial_depth_m : moved, ray_from_axial_);
  return out;
}

SearchFrame rectified(const RgbdFrame& frame, int width_out) { return Rectifier(width_out).rectified(frame); }

}  // namespace sextant
