// SPDX-License-Identifier: Apache-2.0
// The frame as the search wants it: ideal pinhole pixels and depth along the ray (METHOD.md section 1;
// Davies 2015, sec. 3.2).
#pragma once

#include <opencv2/core.hpp>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/geometry/camera_model.h"

namespace sextant {

struct SearchFrame {
  cv::Mat colour;       ///< CV_8UC3, RGB
  cv::Mat ray_depth_m;  ///< CV_32FC1, distance from the focal point, metres; 0 = missing
  PinholeCamera camera;
};

/// Rectifies frames one after another. What depends on the calibration alone is kept from frame to frame and
/// made anew when the calibration changes; the result is the same as that of a fresh one.
class Rectifier {
 public:
  /// width_out: of the search frame, 0 keeps the frame's.
  explicit Rectifier(int width_out = 0) : width_out_(width_out) {}

  /// Rectifies lens distortion and fx != fy, resamples, and converts axial to ray depth:
  /// d = Z sqrt(1 + px^2 + py^2). Colour is interpolated (averaged where it is shrunk), depth never (nearest
  /// sample). Throws InputError where images are empty, of the wrong type, or do not match the calibration.
  SearchFrame rectified(const RgbdFrame& frame);
  /// A colour image (CV_8UC3 of the calibration's size) alone, as the frame's would be. May share its pixels.
  cv::Mat rectified_colour(const CameraModel& camera, const cv::Mat& colour);

 private:
  void prepare(const CameraModel& source);

  int width_out_;
  CameraModel source_;  ///< what the members below were made for
  PinholeCamera ideal_;
  bool as_is_ = false;    ///< pixels are those of the ideal camera already
  bool shrinks_ = false;  ///< colour is averaged down before it is moved
  /// For each ideal pixel, the pixel of the (shrunk) source image, in OpenCV's fixed point: whole pixels
  /// (CV_16SC2) and 1/32 of them (CV_16UC1).
  cv::Mat colour_pixels_, colour_fractions_;
  cv::Mat depth_pixels_;    ///< CV_16SC2: the nearest pixel of the source itself
  cv::Mat ray_from_axial_;  ///< CV_32FC1
};

/// One frame: Rectifier(width_out).rectified(frame).
SearchFrame rectified(const RgbdFrame& frame, int width_out = 0);

}  // namespace sextant
