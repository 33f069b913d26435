// SPDX-License-Identifier: Apache-2.0
// The image's edge that belongs to a point of the model's edge: the nearest one of its direction along the
// normal (Harris & Stennett 1990, RAPiD).
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>

namespace sextant {

/// Signed distance (pixels, along the unit normal) from `pixel` to the nearest pixel of `edges` (CV_8UC1,
/// edges_by_direction) whose edge runs in the direction perpendicular to the normal, within `reach` pixels.
/// Empty where there is none, or where two lie equally far on both sides.
std::optional<double> nearest_edge(const cv::Mat& edges, const Eigen::Vector2d& pixel,
                                   const Eigen::Vector2d& normal, double reach);

}  // namespace sextant
