// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/region_of_interest.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>

#include "runtime/base/error.h"

namespace sextant {
namespace {

/// Exactly N finite numbers, spaces or commas between them.
template <std::size_t N>
std::array<double, N> numbers(const std::string& text, const char* what, const char* form) {
  std::array<double, N> out{};
  const char* at = text.c_str();
  std::size_t count = 0;
  bool good = true;
  while (good && *at != '\0') {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    good = end != at && std::isfinite(value) && count < N;
    if (good) out[count++] = value;
    at = end;
  }
  if (!good || count != N) {
    throw UsageError(std::string(what) + " \"" + text + "\" is not " + form, "numbers with spaces between");
  }
  return out;
}

}  // namespace

bool RegionOfInterest::operator==(const RegionOfInterest& other) const {
  if (workspace_from_camera.has_value() != other.workspace_from_camera.has_value()) return false;
  return image == other.image && workspace == other.workspace &&
         (!workspace_from_camera || workspace_from_camera->matrix() == other.workspace_from_camera->matrix());
}

RegionOfInterest region_from_text(const std::string& image, const std::string& workspace,
                                  const std::string& workspace_from_camera) {
  RegionOfInterest out;
  if (!image.empty()) {
    out.image = numbers<4>(image, "the region", "X Y WIDTH HEIGHT");
    if (!((*out.image)[2] >= 1 && (*out.image)[3] >= 1)) {
      throw UsageError("the region \"" + image + "\" has no pixel", "give a width and height of at least 1");
    }
  }
  if (!workspace.empty()) {
    out.workspace = numbers<6>(workspace, "the workspace", "X0 X1 Y0 Y1 Z0 Z1");
    const auto& w = *out.workspace;
    if (!(w[0] <= w[1] && w[2] <= w[3] && w[4] <= w[5])) {
      throw UsageError("the workspace \"" + workspace + "\" is empty",
                       "give the lower limit of each axis first");
    }
  }
  if (!workspace_from_camera.empty()) {
    const auto p = numbers<7>(workspace_from_camera, "the camera's pose", "X Y Z QX QY QZ QW");
    const Eigen::Quaterniond q(p[6], p[3], p[4], p[5]);
    if (std::abs(q.norm() - 1) > 1e-3) {
      throw UsageError("the camera's pose \"" + workspace_from_camera + "\" has no unit quaternion");
    }
    RigidTransform t = RigidTransform::Identity();
    t.linear() = q.normalized().toRotationMatrix();
    t.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
    out.workspace_from_camera = t;
    if (workspace.empty()) throw UsageError("there is a camera's pose, but no workspace", "give both");
  }
  return out;
}

SearchRegion search_region(const RegionOfInterest& region, const CameraModel& camera,
                           const PinholeCamera& ideal, const std::optional<TableGeometry>& table) {
  SearchRegion out;
  if (region.image) {
    const auto& [x, y, width, height] = *region.image;
    if (x >= camera.width || y >= camera.height || x + width <= 0 || y + height <= 0) {
      throw InputError("region", "it lies outside of the image",
                       "give x, y, width and height in pixels, or 0 0 0 0 for the whole image");
    }
    // Only its part inside the image: lenses are known no farther.
    const double x0 = std::max(x, 0.0), y0 = std::max(y, 0.0);
    out.image = rectified_rectangle(camera, ideal, x0, y0, std::min(x + width, double(camera.width)) - x0,
                                    std::min(y + height, double(camera.height)) - y0);
  }
  if (region.workspace) {
    if (!region.workspace_from_camera && !table) {
      throw InputError("workspace", "it is in the table's frame, but no table is known",
                       "let the table be known, or give the camera's pose in the robot's frame");
    }
    const auto& w = *region.workspace;
    WorkspaceBox box;
    box.workspace_from_camera =
        region.workspace_from_camera ? *region.workspace_from_camera : table_from_camera(*table);
    box.lo = {w[0], w[2], w[4]};
    box.hi = {w[1], w[3], w[5]};
    out.workspace = box;
  }
  return out;
}

}  // namespace sextant
