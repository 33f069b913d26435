// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/marker_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "runtime/publish/message_parts.h"

namespace sextant {

namespace {

// Values of visualization_msgs/Marker (idl/msg/visualization_msgs/Marker.msg).
constexpr int kCube = 1, kLineList = 5, kText = 9, kTriangleList = 11;
constexpr int kAdd = 0, kDeleteAll = 3;

constexpr float kShapeAlpha = 0.6F;
constexpr double kLineWidthMetres = 0.003;
constexpr double kTextHeightMetres = 0.02;

char kShapeSpace[] = "shape";
char kAxesSpace[] = "axes";
char kTextSpace[] = "text";

}  // namespace

std_msgs_msg_dds__ColorRGBA_ confidence_colour(double score, float alpha) {
  const auto s = static_cast<float>(std::clamp(score, 0.0, 1.0));
  return {std::min(1.0F, 2 * (1 - s)), std::min(1.0F, 2 * s), 0, alpha};
}

MarkerMessage MarkersBuilder::start(const FrameResult& result, const char* name_space, int type) const {
  MarkerMessage marker{};
  marker.header = to_header(result);
  marker.ns = const_cast<char*>(name_space);
  marker.type = type;
  marker.action = kAdd;
  marker.pose.orientation.w = 1;
  marker.scale = {1, 1, 1};
  const double whole = std::floor(lifetime_s_);
  marker.lifetime = {static_cast<std::int32_t>(whole),
                     static_cast<std::uint32_t>((lifetime_s_ - whole) * 1e9)};
  // Every string of a message must exist.
  marker.text = marker.mesh_resource = marker.texture_resource = borrowed(empty_);
  marker.texture.format = marker.texture.header.frame_id = marker.mesh_file.filename = borrowed(empty_);
  return marker;
}

void MarkersBuilder::add_shape(const FrameResult& result, const PoseEstimate& estimate,
                               const ObjectShape* shape, bool mesh) {
  if (shape == nullptr || shape->size_m.isZero()) return;
  const bool as_mesh = mesh && !shape->corners.empty();
  MarkerMessage marker = start(result, kShapeSpace, as_mesh ? kTriangleList : kCube);
  marker.id = next_id_;
  marker.color = confidence_colour(estimate.score, kShapeAlpha);
  if (as_mesh) {
    marker.pose = to_pose(estimate.camera_from_object);
    auto& points = points_.emplace_back();
    points.reserve(shape->corners.size());
    for (const Eigen::Vector3f& corner : shape->corners)
      points.push_back({corner.x(), corner.y(), corner.z()});
    marker.points = borrowed_sequence<decltype(marker.points)>(points);
  } else {
    RigidTransform camera_from_box = estimate.camera_from_object;
    camera_from_box.translate(shape->centre_m);
    marker.pose = to_pose(camera_from_box);
    marker.scale = {shape->size_m.x(), shape->size_m.y(), shape->size_m.z()};
  }
  markers_.push_back(marker);
}

void MarkersBuilder::add_axes(const FrameResult& result, const PoseEstimate& estimate, double length_m) {
  MarkerMessage marker = start(result, kAxesSpace, kLineList);
  marker.id = next_id_;
  marker.pose = to_pose(estimate.camera_from_object);
  marker.scale.x = kLineWidthMetres;
  marker.color = {1, 1, 1, 1};
  auto& points = points_.emplace_back();
  points = {{0, 0, 0}, {length_m, 0, 0}, {0, 0, 0}, {0, length_m, 0}, {0, 0, 0}, {0, 0, length_m}};
  marker.points = borrowed_sequence<decltype(marker.points)>(points);
  marker.colors = borrowed_sequence<decltype(marker.colors)>(axis_colours_);
  markers_.push_back(marker);
}

void MarkersBuilder::add_text(const FrameResult& result, const PoseEstimate& estimate,
                              const ObjectShape* shape) {
  MarkerMessage marker = start(result, kTextSpace, kText);
  marker.id = next_id_;
  // Above the object in the image: up is -y of the camera.
  Eigen::Vector3d at = estimate.camera_from_object.translation();
  if (shape != nullptr) {
    at = estimate.camera_from_object * shape->centre_m;
    at.y() -= 0.5 * shape->size_m.norm() + kTextHeightMetres;
  }
  marker.pose.position = {at.x(), at.y(), at.z()};
  marker.scale = {0, 0, kTextHeightMetres};
  marker.color = confidence_colour(estimate.score, 1);
  texts_.push_back(
      fmt::format("{} {:.2f} {}", estimate.object_name, estimate.score, to_string(estimate.status)));
  marker.text = borrowed(texts_.back());
  markers_.push_back(marker);
}

MarkersBuilder::MarkersBuilder(const FrameResult& result, const ObjectShapes& shapes,
                               const MarkerStyle& style)
    : lifetime_s_(style.lifetime_s) {
  const std_msgs_msg_dds__ColorRGBA_ red{1, 0, 0, 1}, green{0, 1, 0, 1}, blue{0, 0, 1, 1};
  axis_colours_ = {red, red, green, green, blue, blue};
  texts_.reserve(result.estimates.size());
  points_.reserve(2 * result.estimates.size());
  MarkerMessage forget = start(result, kShapeSpace, kCube);
  forget.action = kDeleteAll;
  markers_.push_back(forget);
  for (const PoseEstimate& estimate : result.estimates) {
    const auto found = shapes.find(estimate.object_name);
    const ObjectShape* shape = found == shapes.end() ? nullptr : &found->second;
    add_shape(result, estimate, shape, style.mesh);
    add_axes(result, estimate, style.axis_length_m);
    add_text(result, estimate, shape);
    ++next_id_;
  }
  message_.markers = borrowed_sequence<decltype(message_.markers)>(markers_);
}

}  // namespace sextant
