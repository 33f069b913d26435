// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/training_view.h"

#include "offline/learn/view_geometry.h"
#include "runtime/features/edges.h"
#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr int kBorderPx = 6;  ///< for the filters

/// The depth where `item` is seen, else 0.
cv::Mat depth_of(const RenderedView& view, int item) {
  cv::Mat depth = cv::Mat::zeros(view.ray_depth_m.size(), CV_32FC1);
  view.ray_depth_m.copyTo(depth, view.item == item);
  return depth;
}

}  // namespace

TrainingViews::TrainingViews(Renderer& renderer, const Scenery& scenery, int mesh, double bounding_radius_m,
                             double centre_height_m, const LearnParameters& parameters,
                             const RotationBox& box, std::uint64_t seed)
    : renderer_(renderer),
      scenery_(scenery),
      mesh_(mesh),
      radius_m_(bounding_radius_m),
      centre_height_m_(centre_height_m),
      parameters_(parameters),
      box_(box),
      random_(seed) {}

TrainingView TrainingViews::next() {
  const PinholeCamera& camera = parameters_.camera;
  TrainingView view;
  view.pose = random_pose(parameters_, box_, radius_m_, random_);
  view.window = window_around(camera, view.pose, radius_m_, kBorderPx);
  const Light light = random_light(parameters_, view.pose, random_);
  // A background of any grey, slightly tinted, where no table is seen.
  const double grey = random_.uniform(0, 255);
  const double tint_r = random_.uniform(-20, 20);
  const double tint_g = random_.uniform(-20, 20);
  const double tint_b = random_.uniform(-20, 20);
  const Eigen::Vector3d background(grey + tint_r, grey + tint_g, grey + tint_b);
  std::vector<RenderItem> items{{mesh_, transform_from_pose(camera, view.pose)}};
  const auto table =
      static_cast<std::size_t>(random_.integer(0, static_cast<int>(scenery_.plain_tables.size()) - 1));
  if (table_is_seen(view.pose)) {
    items.push_back({scenery_.plain_tables[table], camera_from_table(camera, view.pose, centre_height_m_)});
  }
  const RenderedView rendered =
      renderer_.render(camera, view.window, items, light, background.cwiseMax(0).cwiseMin(255));
  view.edges = edges_by_direction(rendered.colour, {parameters_.edge_low, parameters_.edge_high});
  view.ray_depth_m = depth_of(rendered, 0);
  view.table_depth_m = depth_of(rendered, 1);
  return view;
}

}  // namespace sextant
