// SPDX-License-Identifier: Apache-2.0
// What the depth image says about a pose: at each pixel of the object's picture, how much farther the sensor
// sees than the mesh is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "runtime/frame/search_frame.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/refine/depth_raster.h"
#include "runtime/refine/normal_equations.h"
#include "runtime/refine/refinement.h"

namespace sextant {

/// Adds the ray-depth residuals of a few hundred pixels spread over the picture. `raster`: the mesh at the
/// pose; `face_normals`: of its triangles, object frame; `shared`: current estimate of what the pixels share;
/// residuals beyond gate_m (or 4 sigma) do not count. Pixels without depth are unknown; pixels beside the
/// silhouette are left out (sensors are unsure of where it is). Where `quality` is given, its depth shares
/// are filled in.
void add_depth_term(const SearchFrame& frame, const DepthRaster& raster,
                    const std::vector<Eigen::Vector3f>& face_normals, const RigidTransform& pose,
                    const Shared& shared, double gate_m, NormalEquations& normal, Refinement* quality);

}  // namespace sextant
