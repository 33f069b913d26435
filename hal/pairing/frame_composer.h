// SPDX-License-Identifier: Apache-2.0
// One RGB-D frame from a colour image and a depth image of two cameras: depth registered into the colour
// camera, and where it is asked for both rectified and resampled in the same step, so that depth is moved
// only once.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "runtime/frame/depth_registration.h"
#include "runtime/frame/rgbd_frame.h"
#include "runtime/frame/search_frame.h"

namespace sextant {

/// How two cameras see.
struct RgbdCalibration {
  CameraModel colour;
  CameraModel depth;                                              ///< ignored where depth_is_registered
  RigidTransform colour_from_depth = RigidTransform::Identity();  ///< metres
  bool depth_is_registered = false;  ///< the device has registered it: same size, same calibration as colour
};

/// What frames should look like.
struct ComposerOptions {
  bool rectify = false;  ///< ideal pixels: lens distortion and fx != fy are undone
  int width = 0;         ///< of the frames, pixels; 0: the colour image's. Another width implies rectify
};

/// One thread at a time.
class FrameComposer {
 public:
  /// Throws InputError(where) for calibrations that are none.
  FrameComposer(const RgbdCalibration& calibration, const ComposerOptions& options, const std::string& where);

  /// colour: CV_8UC3 RGB; axial_depth_m: CV_32FC1 metres, 0 = missing; each of its calibration's size. Fills
  /// images and camera of the frame; without anything to do the pixels are shared, not copied. Throws
  /// InputError for images that do not match the calibration.
  RgbdFrame compose(const cv::Mat& colour, const cv::Mat& axial_depth_m);

  /// The camera that the frames have.
  const CameraModel& camera() const { return camera_; }

 private:
  RgbdCalibration calibration_;
  std::string where_;
  bool rectifies_ = false;
  CameraModel camera_;
  Rectifier rectifier_;
  std::unique_ptr<DepthRegistration> registration_;  ///< none: depth is as the frame wants it
};

}  // namespace sextant
