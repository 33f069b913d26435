// SPDX-License-Identifier: Apache-2.0
// The frame's tables made again in the plainest way, to check the ones that are used: distances by trying
// every feature near enough, windows by looking at every pixel that can be their minimum.
#pragma once

#include <string>

#include "runtime/frame/search_frame.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

/// Empty where every value of every table (windows included) is what the frame says; else the first that is
/// not.
std::string wrong_table(const FrameTables& tables, const SearchFrame& frame, const cv::Mat& edges);

}  // namespace sextant
