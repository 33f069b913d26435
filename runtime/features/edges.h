// SPDX-License-Identifier: Apache-2.0
// Visual features: Canny edges in eight undirected directions (Davies 2015, sec. 5.1; Canny 1986). Integer
// arithmetic only, so that every CPU sees the same edges; learning and detection call the same function.
#pragma once

#include <opencv2/core.hpp>

#include "runtime/features/gradient.h"
#include "runtime/features/thinning.h"

namespace sextant {

/// Thresholds are for the Euclidean norm of the 3x3 Sobel gradient of 8-bit images: a sharp step of s grey
/// levels gives 4 s.
struct EdgeOptions {
  int low = 60;    ///< weak edges that touch strong ones are kept, 1..4000
  int high = 120;  ///< strong edges, low..4000
  /// Lowers both thresholds in dark, hazy or blurred pictures: `high` to the gradient that adapt_permille of
  /// the pixels exceed, but not below adapt_least; `low` in proportion. 0: never.
  int adapt_permille = 0;  ///< 0..1000
  int adapt_least = 30;    ///< 1..high
};

/// What a frame from a camera is searched with (docs/SCORING.md).
inline constexpr EdgeOptions kFrameEdges{60, 120, 80, 30};

/// Edges by direction: CV_8UC1, bit k set where the pixel is an edge whose line runs within 22.5 deg of
/// k * 22.5 deg (x right, y down; 0 = horizontal): every edge is of the two nearest kinds. With one kind
/// each, an edge that turns by the 20 deg of a viewpoint bin always leaves its kind in some training views,
/// and a plain box had next to no visual parts. colour: CV_8UC3. Per pixel the channel with the largest
/// gradient counts.
cv::Mat edges_by_direction(const cv::Mat& colour, const EdgeOptions& options = {});

/// The same for a stream of images: keeps its memory from one to the next.
class EdgeFinder {
 public:
  cv::Mat edges_by_direction(const cv::Mat& colour, const EdgeOptions& options);

 private:
  Gradient gradient_;
  Thinning thinning_;
};

/// Mask of the two kinds 0..7 of an edge with integer gradient (dx, dy), not both 0; |dx|, |dy| < 32768.
unsigned edge_kinds(int dx, int dy);

}  // namespace sextant
