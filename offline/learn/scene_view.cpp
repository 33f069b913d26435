// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/scene_view.h"

#include <array>
#include <cmath>
#include <numbers>

#include "offline/learn/view_geometry.h"
#include "offline/synthesize/colour_sensor.h"
#include "offline/synthesize/depth_sensor.h"
#include "runtime/features/edges.h"
#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr int kBorderPx = 12;
const Eigen::Vector3d kBackground(96, 98, 102);

RigidTransform standing_at(double x, double y, double yaw_rad) {
  return Eigen::Translation3d(x, y, 0) * Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
}

/// What the sensor makes of a window of the image.
void sense(const RenderedView& view, const PinholeCamera& camera, const EdgeOptions& edges, Random& random,
           SceneView& out) {
  static const std::array<DepthSensor, 3> kSensors{depth_sensor("kinect1"), depth_sensor("xtion"),
                                                   depth_sensor("realsense")};
  const DepthSensor& sensor = kSensors[static_cast<std::size_t>(random.integer(0, 2))];
  cv::Mat per_axial(view.ray_depth_m.size(), CV_32FC1);  // ray depth per axial depth
  for (int y = 0; y < per_axial.rows; ++y) {
    for (int x = 0; x < per_axial.cols; ++x) {
      per_axial.at<float>(y, x) = static_cast<float>(1 / camera.ray(x + out.window.x, y + out.window.y).z());
    }
  }
  const cv::Mat axial = view.ray_depth_m / per_axial;
  out.ray_depth_m = apply_depth_sensor(axial, camera.focal, sensor, random.bits()).mul(per_axial);
  out.edges = edges_by_direction(apply_colour_sensor(view.colour, {}, random.bits()), edges);
}

}  // namespace

SceneViews::SceneViews(Renderer& renderer, const Scenery& scenery, int mesh, double bounding_radius_m,
                       double centre_height_m, int symmetry_deg, const LearnParameters& parameters,
                       const RotationBox& box, std::uint64_t seed)
    : renderer_(renderer),
      scenery_(scenery),
      mesh_(mesh),
      radius_m_(bounding_radius_m),
      centre_height_m_(centre_height_m),
      symmetry_deg_(symmetry_deg),
      parameters_(parameters),
      box_(box),
      random_(seed) {}

void SceneViews::add_surroundings(const RigidTransform& camera_from_foot, SceneTruth truth,
                                  std::vector<RenderItem>& items) {
  const auto pick = [&](const auto& from) -> const auto& {
    return from[static_cast<std::size_t>(random_.integer(0, static_cast<int>(from.size()) - 1))];
  };
  const auto turn = [&] { return random_.uniform(-std::numbers::pi, std::numbers::pi); };
  const double x = random_.uniform(-0.5, 0.5);
  const double y = random_.uniform(-0.5, 0.5);
  items.push_back({pick(scenery_.textured_tables), camera_from_foot * standing_at(x, y, turn())});
  if (truth == SceneTruth::kClutter) {
    const double shift = 0.3 * radius_m_;
    const double dx = random_.uniform(-shift, shift);
    const double dy = random_.uniform(-shift, shift);
    items.push_back({pick(scenery_.things).mesh, camera_from_foot * standing_at(dx, dy, turn())});
  }
  const int neighbours = random_.integer(1, 4);
  for (int i = 0; i < neighbours; ++i) {
    const SceneryThing& thing = pick(scenery_.things);
    const double angle = turn();
    const double away = 0.8 * radius_m_ + thing.radius_m + 0.008 + 0.3 * std::pow(random_.uniform(), 2);
    items.push_back(
        {thing.mesh, camera_from_foot * standing_at(away * std::cos(angle), away * std::sin(angle), turn())});
  }
}

SceneView SceneViews::next(SceneTruth truth) {
  SceneView out;
  out.hypothesis = random_pose(parameters_, box_, radius_m_, random_);
  out.window = window_around(parameters_.camera, out.hypothesis, radius_m_, kBorderPx);
  Pose6 real = out.hypothesis;
  if (box_.hi_deg[2] - box_.lo_deg[2] == 1) real.rz = random_.uniform(0, 2 * std::numbers::pi);
  if (truth == SceneTruth::kTurnedObject) {
    const double width = (box_.hi_deg[2] - box_.lo_deg[2]) * std::numbers::pi / 180;
    real.rz += random_.uniform(width, symmetry_deg_ * std::numbers::pi / 180 - width);
  }
  std::vector<RenderItem> items;
  if (truth != SceneTruth::kClutter) items.push_back({mesh_, transform_from_pose(parameters_.camera, real)});
  const RigidTransform foot = camera_from_table(parameters_.camera, real, centre_height_m_);
  if (table_is_seen(real)) add_surroundings(foot, truth, items);
  const RenderedView view = renderer_.render(parameters_.camera, out.window, items,
                                             random_light(parameters_, real, random_), kBackground);
  sense(view, parameters_.camera, {parameters_.edge_low, parameters_.edge_high}, random_, out);
  return out;
}

}  // namespace sextant
