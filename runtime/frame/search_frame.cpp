// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/search_frame.h"

#include <cmath>
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

void axial_to_ray(const PinholeCamera& camera, cv::Mat& depth) {
  for (int y = 0; y < camera.height; ++y) {
    auto* row = depth.ptr<float>(y);
    const double py = (y - camera.cy) / camera.focal;
    for (int x = 0; x < camera.width; ++x) {
      const double px = (x - camera.cx) / camera.focal;
      const bool usable = std::isfinite(row[x]) && row[x] > 0;
      row[x] = usable ? static_cast<float>(row[x] * std::sqrt(1 + px * px + py * py)) : 0.0F;
    }
  }
}

}  // namespace

SearchFrame rectified(const RgbdFrame& frame, int width_out) {
  check(frame);
  SearchFrame out;
  out.camera = frame.camera.ideal(width_out);
  const bool as_is = frame.camera.is_ideal() && out.camera.width == frame.camera.width;
  if (as_is) {
    out.colour = frame.colour;
    out.ray_depth_m = frame.axial_depth_m.clone();
  } else {
    const cv::Mat map = source_pixels(frame.camera, out.camera);
    cv::remap(frame.colour, out.colour, map, cv::Mat(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::remap(frame.axial_depth_m, out.ray_depth_m, map, cv::Mat(), cv::INTER_NEAREST, cv::BORDER_CONSTANT,
              0);
  }
  axial_to_ray(out.camera, out.ray_depth_m);
  return out;
}

}  // namespace sextant
