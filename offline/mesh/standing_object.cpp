// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/standing_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "offline/mesh/bounding_sphere.h"
#include "offline/mesh/convex_hull.h"
#include "offline/mesh/mass.h"
#include "offline/mesh/mesh_reader.h"
#include "offline/mesh/resting_poses.h"
#include "offline/mesh/symmetry.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr double kLeastRadius_m = 0.005;
constexpr double kMostRadius_m = 1.0;

std::optional<Eigen::Vector3d> axis_named(const std::string& name) {
  const bool minus = name.size() == 2 && name[0] == '-';
  const std::size_t axis = std::string("xyz").find(name.empty() ? '?' : name.back());
  if (axis == std::string::npos || name.size() != (minus ? 2U : 1U)) return std::nullopt;
  return (minus ? -1 : 1) * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
}

void check_options(const MeshOptions& options) {
  if (!(options.metres_per_unit > 0) || !std::isfinite(options.metres_per_unit)) {
    throw UsageError("the mesh's unit must be a positive length", "give --units m, cm, mm or in");
  }
  if (!options.up.empty() && !axis_named(options.up)) {
    throw UsageError("--up " + options.up + " is no axis", "give x, y, z, -x, -y or -z");
  }
  if (!options.up.empty() && options.rest) {
    throw UsageError("--up and --rest contradict each other", "give one of them");
  }
  if (options.symmetry_deg) {
    const int s = *options.symmetry_deg;
    if (s != 0 && s != 90 && s != 180 && s != 360) {
      throw UsageError(fmt::format("--symmetry-deg {} is not known", s),
                       "give 0 (any turn), 90, 180, 360 or auto");
    }
  }
}

void check_size(double radius_m, double metres_per_unit, const std::string& where) {
  if (radius_m >= kLeastRadius_m && radius_m <= kMostRadius_m) return;
  struct Unit {
    const char* name;
    double metres;
  };
  std::string advice = "check its units (--units)";
  for (const Unit& unit : {Unit{"mm", 0.001}, Unit{"m", 1}, Unit{"cm", 0.01}, Unit{"in", 0.0254}}) {
    const double in_that_unit = radius_m / metres_per_unit * unit.metres;
    if (in_that_unit < kLeastRadius_m || in_that_unit > kMostRadius_m) continue;
    advice = fmt::format("if the file is in {}, give --units {} (radius {:.3g} m)", unit.name, unit.name,
                         in_that_unit);
    break;
  }
  throw InputError(where, fmt::format("has a radius of {:.3g} m, outside of 0.005 to 1 m", radius_m), advice);
}

Eigen::Matrix3d standing_rotation(const MeshOptions& options, const std::vector<RestingPose>& poses,
                                  const std::string& where) {
  if (const std::optional<Eigen::Vector3d> up = axis_named(options.up)) return rotation_that_raises(*up);
  if (poses.empty())
    throw InputError(where, "is flat: it has no resting poses", "say which axis is up (--up)");
  const int rest = options.rest.value_or(0);
  if (rest < 0 || rest >= static_cast<int>(poses.size())) {
    std::string list = describe_resting_poses(poses);
    list.erase(list.find_last_not_of('\n') + 1);
    for (std::size_t at = 0; (at = list.find('\n', at)) != std::string::npos;) list.replace(at, 1, "; ");
    throw UsageError(fmt::format("--rest {} is not one of the mesh's {} resting poses", rest, poses.size()),
                     "choose from " + list);
  }
  return poses[static_cast<std::size_t>(rest)].object_from_mesh;
}

// The more symmetric of two: 0 before 90 before 180 before 360.
int more_symmetric(int a_deg, int b_deg) { return std::min(a_deg, b_deg); }

}  // namespace

StandingObject load_standing_object(const std::filesystem::path& file, const MeshOptions& options) {
  check_options(options);
  StandingObject object;
  object.mesh = read_mesh(file, options.metres_per_unit);
  object.file_hash = mesh_file_hash(file);
  Mesh& mesh = object.mesh;

  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : mesh.vertices) points.push_back(p.cast<double>());
  const Sphere sphere = smallest_sphere(points);
  check_size(sphere.radius, options.metres_per_unit, file.string());
  if (options.up.empty()) {
    if (const std::optional<ConvexHull> hull = convex_hull(points)) {
      object.resting_poses = resting_poses(*hull, centre_of_mass(mesh, *hull));
    }
  }

  const Eigen::Matrix3d rotation = standing_rotation(options, object.resting_poses, file.string());
  object.object_from_mesh.linear() = rotation;
  object.object_from_mesh.translation() = -(rotation * sphere.centre);
  double lowest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = object.object_from_mesh * points[i];
    mesh.vertices[i] = p.cast<float>();
    mesh.normals[i] = (rotation * mesh.normals[i].cast<double>()).cast<float>();
    object.bounding_radius_m = std::max(object.bounding_radius_m, mesh.vertices[i].cast<double>().norm());
    lowest = std::min(lowest, static_cast<double>(mesh.vertices[i].z()));
  }
  object.centre_height_m = -lowest;

  const TurnSymmetry symmetry = detect_turn_symmetry(mesh, object.bounding_radius_m);
  object.symmetry_deg = options.symmetry_deg.value_or(symmetry.with_print_deg);
  object.geometric_symmetry_deg = more_symmetric(symmetry.of_shape_deg, object.symmetry_deg);
  return object;
}

}  // namespace sextant
