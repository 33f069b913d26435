// SPDX-License-Identifier: Apache-2.0
// models/models_info.json of a BOP data set: size and symmetries of the objects, with our keys beside BOP's:
// "sextant_up" (the mesh's axis that points up when the object stands), "sextant_symmetry_deg" (0 rotational,
// 90, 180, 360) about that axis with the print, "sextant_geometric_symmetry_deg" of the shape alone.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "offline/mesh/standing_object.h"

namespace sextant {

/// A rotational symmetry about an axis through a point, mesh frame.
struct AxialSymmetry {
  Eigen::Vector3d axis{0, 0, 1};      ///< unit
  Eigen::Vector3d offset_m{0, 0, 0};  ///< a point on the axis, metres
};

/// What is known of one object. Lengths in metres, mesh frame.
struct ModelInfo {
  double diameter_m = 0;  ///< largest distance of two vertices
  std::optional<Eigen::Vector3d> min_m;
  std::optional<Eigen::Vector3d> size_m;
  std::vector<AxialSymmetry> continuous;  ///< symmetries_continuous
  std::vector<RigidTransform> discrete;   ///< symmetries_discrete, without the identity
  std::optional<Eigen::Vector3d> up;      ///< sextant_up, unit
  std::optional<int> symmetry_deg;        ///< sextant_symmetry_deg
  std::optional<int> geometric_symmetry_deg;

  /// Centre of the bounding box, the origin where the box is unknown.
  Eigen::Vector3d centre_m() const;
};

using ModelsInfo = std::map<int, ModelInfo>;  ///< by object id

/// Measures a mesh that stands; BOP's symmetries are those with the print.
ModelInfo measure_model(const StandingObject& object);

/// Throws InputError naming file, object and key. Keys that are not ours or BOP's are ignored.
ModelsInfo read_models_info(const std::filesystem::path& file);
/// Throws InputError where it cannot be written.
void write_models_info(const std::filesystem::path& file, const ModelsInfo& models);

}  // namespace sextant
