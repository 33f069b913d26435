// SPDX-License-Identifier: Apache-2.0
// Looking at a part of the image only: the frame is cut to it, with its calibration, so that everything after
// works on fewer pixels. Poses do not change by that; boxes in the image are moved back.
#pragma once

#include "runtime/frame/rgbd_frame.h"
#include "runtime/publish/command.h"

namespace sextant {

/// Smallest width and height of a region, pixels.
inline constexpr std::uint32_t kSmallestRegion = 32;

/// Throws InputError where less than kSmallestRegion of the region lies inside an image of that size. All
/// zero is good.
void check_region(const ImageRegion& region, int width, int height);

/// The part of the frame inside the region (not copied), or the frame itself for an all-zero one. Throws as
/// check_region does.
RgbdFrame cut_to_region(const RgbdFrame& frame, const ImageRegion& region);

/// Boxes of a result of the cut frame in pixels of the whole one.
void move_boxes_back(FrameResult& result, const ImageRegion& region);

}  // namespace sextant
