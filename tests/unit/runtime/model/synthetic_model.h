// SPDX-License-Identifier: Apache-2.0
// Models for tests: a box whose parts follow from geometry, so that they look right when drawn, and a random
// one with coefficients as wild as least squares can give.
#pragma once

#include <cstdint>

#include "runtime/model/object_model.h"

namespace sextant::test {

/// Rotation of the object in the tangent frame: Rz(rx) Rx(-ry) B Rz(rz) of runtime/geometry/pose_mapping.h.
Eigen::Matrix3d tangent_from_object(double rx, double ry, double rz);

/// A box of 0.16 x 0.06 x 0.21 m seen from above, bins of 20 degrees: rx one bin around 0, ry -60..-20 in two
/// bins, rz 0..20 * turntable_bins. Per bin `parts` edge parts on visible edges, `parts` depth parts.
ObjectModel make_box_model(int turntable_bins, int parts, std::uint64_t seed);

/// Bins anywhere in -180..360 degrees, 10 to 90 degrees wide (the thesis tried 10 to 40). Values at the
/// centre within the radius, slopes as steep as least squares can fit to points within the sphere: the
/// variance that a line explains, sum of (slope * half width)^2 / 3, is at most that of the points, radius^2.
ObjectModel make_random_model(int bins, int parts, double radius_m, std::uint64_t seed);

}  // namespace sextant::test
