// SPDX-License-Identifier: Apache-2.0
// A picture of what a model has learned: per viewpoint bin the object as seen at the bin's centre, once with
// its visual parts as short strokes along the edge direction that they expect, once with its depth parts as
// dots coloured by the depth that they expect (Davies 2015, ch. 3 and the figures of ch. 4).
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

inline constexpr std::size_t kMaxSheetBins = 400;

/// How to draw a contact sheet.
struct ContactSheetOptions {
  std::size_t max_bins =
      24;              ///< 1..kMaxSheetBins; where the model has more, bins evenly spread over the list
  int panel_px = 240;  ///< side of one panel; a bin has two side by side; 64..512
};

/// Which bins a sheet of at most max_bins shows: all of them, or evenly spread ones.
/// In increasing order, each once.
std::vector<std::size_t> bins_of_sheet(std::size_t bin_count, std::size_t max_bins);

/// Draws the sheet: CV_8UC3, RGB. The model must have passed check_model (every model of a file has).
cv::Mat draw_contact_sheet(const ObjectModel& model, const ContactSheetOptions& options);

}  // namespace sextant
