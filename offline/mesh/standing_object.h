// SPDX-License-Identifier: Apache-2.0
// From a mesh file to an object that stands: units, up axis or resting pose, bounding sphere, symmetry.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "offline/mesh/mesh.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// A way in which the object can lie on a table (stable resting pose).
struct RestingPose {
  Eigen::Matrix3d object_from_mesh;  ///< rotation that turns the mesh so that it stands, z up
  double probability = 0;            ///< of landing on this face when dropped, 0..1
  double height_m = 0;               ///< of the object in this pose
};

/// How to read a mesh.
struct MeshOptions {
  double metres_per_unit = 1.0;     ///< --units: 1 for m, 0.001 for mm
  std::string up;                   ///< "x", "y", "z", "-x", "-y", "-z", or empty: use rest
  std::optional<int> rest;          ///< index into resting_poses; empty: the most likely one
  std::optional<int> symmetry_deg;  ///< 0, 90, 180, 360; empty: detect
};

/// A mesh that stands on the table z = -centre_height_m, its bounding sphere's centre in the origin.
struct StandingObject {
  Mesh mesh;                                                     ///< object frame, metres
  RigidTransform object_from_mesh = RigidTransform::Identity();  ///< from the mesh's frame in metres
  double bounding_radius_m = 0;
  double centre_height_m = 0;
  int symmetry_deg = 360;                  ///< with the print (colours, texture)
  int geometric_symmetry_deg = 360;        ///< of the shape alone
  std::vector<RestingPose> resting_poses;  ///< most likely first; empty where `up` was given
  std::uint64_t file_hash = 0;             ///< XXH3-64 of the mesh file's bytes
};

/// Reads any of PLY, OBJ, STL, glTF/GLB, DAE. Throws InputError for a mesh that cannot be used.
StandingObject load_standing_object(const std::filesystem::path& file, const MeshOptions& options);

}  // namespace sextant
