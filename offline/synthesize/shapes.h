// SPDX-License-Identifier: Apache-2.0
// Simple meshes for the scenes around a target: they stand on z = 0, their axis is z, texture coordinates
// cover 0..1.
#pragma once

#include <vector>

#include "offline/mesh/mesh.h"

namespace sextant {

/// Axis-aligned box of full sizes, metres.
Mesh box_shape(double size_x, double size_y, double size_z);

/// Surface of revolution. profile: (radius, z) from the bottom up, metres; corners sharper than 40 deg stay
/// sharp.
Mesh lathe_shape(const std::vector<Eigen::Vector2d>& profile, int segments = 48);
Mesh cylinder_shape(double radius, double height);
Mesh sphere_shape(double radius);
/// A bottle: body, shoulder, neck.
Mesh bottle_shape(double radius, double height);

/// A rectangle in z = 0 with its normal up, centred.
Mesh rectangle_shape(double size_x, double size_y);

/// The same mesh with an image on all of it (white vertices) or with one colour (RGB 0..1).
Mesh with_texture(Mesh mesh, cv::Mat texture);
Mesh with_colour(Mesh mesh, const Eigen::Vector3f& colour);

}  // namespace sextant
