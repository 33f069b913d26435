// SPDX-License-Identifier: Apache-2.0
// The picture that shows an answer: on the colour image the outline of every object found, the axes of its
// mesh frame, its name, score and certificate, and below what was proven of the objects that were not found.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/model/object_model.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// CV_8UC3, RGB: the frame enlarged by a whole number so that lines and letters are fine (640 pixels become
/// 1280), drawn upon. Axes: x red, y green, z blue. Estimates whose object has no model here get their box
/// only.
cv::Mat draw_overlay(const RgbdFrame& frame, const FrameResult& result,
                     const std::vector<ObjectModel>& models);

}  // namespace sextant
