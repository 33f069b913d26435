// SPDX-License-Identifier: Apache-2.0
// What the image's edges say about a pose: how far the edges that the model should show are from those that
// are there, across their direction.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/refine/contour_edges.h"
#include "runtime/refine/normal_equations.h"
#include "runtime/refine/refinement.h"

namespace sextant {

/// Adds the distances of the samples (of the model at the pose, unhidden by itself) to the nearest edges of
/// their direction within reach_px (pixels at f = 525). Samples where the depth image shows something 3 cm or
/// more in front are hidden and say nothing. All of it counts the less, the fewer samples find an edge within
/// two pixels: where print and shadows are all that is found, they must not outvote the depth. Where
/// `quality` is given, its edge shares are filled in.
void add_edge_term(const SearchFrame& frame, const cv::Mat& edges, const std::vector<EdgeSample>& samples,
                   const RigidTransform& pose, double reach_px, NormalEquations& normal, Refinement* quality);

/// Pixels at f = 525 -> pixels of this camera. Coarser cameras are not asked for less than a pixel.
double edge_scale(const PinholeCamera& camera);

}  // namespace sextant
