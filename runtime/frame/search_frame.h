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

/// Rectifies lens distortion and fx != fy, resamples to width_out (0: keep) and converts axial to ray depth:
/// d = Z sqrt(1 + px^2 + py^2). Colour is interpolated, depth never (nearest sample).
/// Throws InputError where images are empty, of the wrong type, or do not match the calibration.
SearchFrame rectified(const RgbdFrame& frame, int width_out = 0);

}  // namespace sextant
