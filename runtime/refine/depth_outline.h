// SPDX-License-Identifier: Apache-2.0
// What the depth image says about a pose's outline: where the surface ends and something farther begins. A
// box without print may slide along its faces and still fit all depth on them; the print of the real one has
// edges parallel to the outline. That the camera sees past the object holds it.
#pragma once

#include <optional>
#include <vector>

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/refine/contour_edges.h"
#include "runtime/refine/depth_raster.h"
#include "runtime/refine/normal_equations.h"

namespace sextant {

/// Signed distance (pixels, along the sample's normal) from a silhouette's sample to where the measured depth
/// leaves the surface for something at least 2.5 cm farther, within `reach` pixels. Empty where it does not,
/// where something in front comes first, where more than three pixels in between are missing, or where the
/// model itself lies behind its silhouette. `raster`: the model at the sample's pose.
std::optional<double> depth_outline_at(const SearchFrame& frame, const DepthRaster& raster,
                                       const EdgeSample& sample, double reach);

/// Adds these distances of the silhouette's samples. reach_px: pixels at f = 525. shared: what is known of
/// the shift between depth and colour.
void add_depth_outline_term(const SearchFrame& frame, const DepthRaster& raster,
                            const std::vector<EdgeSample>& samples, const RigidTransform& pose,
                            const Shared& shared, double reach_px, NormalEquations& normal);

}  // namespace sextant
