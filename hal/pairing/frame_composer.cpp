// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/frame_composer.h"

#include "runtime/base/error.h"

namespace sextant {
namespace {

CameraModel model_of(const PinholeCamera& ideal) {
  CameraModel camera;
  camera.width = ideal.width;
  camera.height = ideal.height;
  camera.fx = ideal.focal;
  camera.fy = ideal.focal;
  camera.cx = ideal.cx;
  camera.cy = ideal.cy;
  return camera;
}

void require(const cv::Mat& image, int type, const CameraModel& camera, const std::string& where,
             const char* which) {
  if (image.type() == type && image.cols == camera.width && image.rows == camera.height) return;
  throw InputError(where,
                   std::string("the ") + which + " image is " + std::to_string(image.cols) + " x " +
                       std::to_string(image.rows) + ", its calibration is for " +
                       std::to_string(camera.width) + " x " + std::to_string(camera.height),
                   "give the calibration of this image size");
}

}  // namespace

FrameComposer::FrameComposer(const RgbdCalibration& calibration, const ComposerOptions& options,
                             const std::string& where)
    : calibration_(calibration), where_(where), rectifier_(options.width) {
  calibration.colour.check(where + ": colour camera");
  if (calibration_.depth_is_registered) {
    calibration_.depth = calibration.colour;
    calibration_.colour_from_depth = RigidTransform::Identity();
  }
  const CameraModel& colour = calibration.colour;
  const bool resizes = options.width > 0 && options.width != colour.width;
  rectifies_ = resizes || (options.rectify && !colour.is_ideal());
  camera_ = rectifies_ ? model_of(colour.ideal(options.width)) : colour;
  // Its maps take longer than a frame lasts: made now, so that the first frame is not late.
  if (rectifies_) rectifier_.rectified_colour(colour, cv::Mat::zeros(colour.height, colour.width, CV_8UC3));
  if (rectifies_ || !calibration_.depth_is_registered) {
    registration_ = std::make_unique<DepthRegistration>(calibration_.depth, camera_,
                                                        calibration_.colour_from_depth, where);
  }
}

RgbdFrame FrameComposer::compose(const cv::Mat& colour, const cv::Mat& axial_depth_m) {
  require(colour, CV_8UC3, calibration_.colour, where_, "colour");
  require(axial_depth_m, CV_32FC1, calibration_.depth, where_, "depth");
  RgbdFrame frame;
  frame.camera = camera_;
  frame.colour = rectifies_ ? rectifier_.rectified_colour(calibration_.colour, colour) : colour;
  frame.axial_depth_m = registration_ ? registration_->registered(axial_depth_m) : axial_depth_m;
  return frame;
}

}  // namespace sextant
