// SPDX-License-Identifier: Apache-2.0
// The colour image with the poses drawn into it: outline coloured by confidence, axes, name and score.
#pragma once

#include <opencv2/core.hpp>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/publish/object_shape.h"
#include "runtime/refine/frame_result.h"

namespace sextant {

/// A new CV_8UC3 image, RGB. Objects without a shape are drawn as their box in the image.
cv::Mat annotate(const RgbdFrame& frame, const FrameResult& result, const ObjectShapes& shapes);

}  // namespace sextant
