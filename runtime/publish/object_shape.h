// SPDX-License-Identifier: Apache-2.0
// What an object looks like to those who draw it or plan around it, in the mesh's own frame.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

namespace sextant {

struct ObjectShape {
  Eigen::Vector3d centre_m{0, 0, 0};       ///< of the smallest box along the axes of the mesh's own frame
  Eigen::Vector3d size_m{0, 0, 0};         ///< of that box
  std::vector<Eigen::Vector3f> corners{};  ///< of the triangles, three by three, metres
};

/// By object name.
using ObjectShapes = std::map<std::string, ObjectShape>;

}  // namespace sextant
