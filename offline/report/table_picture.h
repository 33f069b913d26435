// SPDX-License-Identifier: Apache-2.0
// The picture that shows whether a camera and its table estimate can be trusted: colour with a 10 cm grid
// laid on the table, beside it the depth with its holes and what lies on the plane.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// CV_8UC3, RGB, twice the frame's width plus a strip of text. The grid is drawn where frame.table is known,
/// with lines through depth that hides them left out. Depth: near red to far blue, missing black, on the
/// table (within 1 cm) white-ish. lines: written below.
cv::Mat draw_table_picture(const RgbdFrame& frame, const std::vector<std::string>& lines);

}  // namespace sextant
