// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/detect_wire.h"

#include <set>

namespace sextant {
namespace {

/// What of the options is plain numbers.
struct OptionNumbers {
  TableSource table;
  std::array<double, 4> fixed_table;
  TableTolerance tolerance;
  int max_detections, search_width;
  double min_distance_m, max_distance_m;
  bool runner_up;
  double runner_up_radius_m, runner_up_angle_rad, runner_up_most;
};

void append_text(Bytes& bytes, const std::string& text) {
  append(bytes, text.size());
  const std::size_t at = bytes.size();
  bytes.resize(at + text.size());
  std::memcpy(bytes.data() + at, text.data(), text.size());
}

std::string take_text(ByteReader& reader) {
  const auto size = reader.take<std::size_t>();
  return {reinterpret_cast<const char*>(reader.take(size)), size};
}

template <typename Plain>
void append_maybe(Bytes& bytes, const std::optional<Plain>& value) {
  append(bytes, value.has_value());
  if (value) append(bytes, *value);
}

template <typename Plain>
std::optional<Plain> take_maybe(ByteReader& reader) {
  if (!reader.take<bool>()) return std::nullopt;
  return reader.take<Plain>();
}

using TransformRows = std::array<double, 12>;

TransformRows rows_of(const RigidTransform& t) {
  TransformRows rows;
  for (int i = 0; i < 12; ++i) rows[static_cast<std::size_t>(i)] = t.matrix()(i / 4, i % 4);
  return rows;
}

RigidTransform transform_of(const TransformRows& rows) {
  RigidTransform t = RigidTransform::Identity();
  for (int i = 0; i < 12; ++i) t.matrix()(i / 4, i % 4) = rows[static_cast<std::size_t>(i)];
  return t;
}

}  // namespace

void append_options(Bytes& bytes, const DetectOptions& o) {
  OptionNumbers n{};
  n.table = o.table;
  const Eigen::Vector3d& up = o.fixed_table.up_in_camera;
  n.fixed_table = {up.x(), up.y(), up.z(), o.fixed_table.camera_height_m};
  n.tolerance = o.tolerance;
  n.max_detections = o.max_detections;
  n.search_width = o.search_width;
  n.min_distance_m = o.min_distance_m;
  n.max_distance_m = o.max_distance_m;
  n.runner_up = o.runner_up;
  n.runner_up_radius_m = o.runner_up_radius_m;
  n.runner_up_angle_rad = o.runner_up_angle_rad;
  n.runner_up_most = o.runner_up_most;
  append(bytes, n);
  append_text(bytes, o.scoring);
  append_maybe(bytes, o.threshold);
  append_maybe(bytes, o.region.image);
  append_maybe(bytes, o.region.workspace);
  std::optional<TransformRows> frame;
  if (o.region.workspace_from_camera) frame = rows_of(*o.region.workspace_from_camera);
  append_maybe(bytes, frame);
}

DetectOptions take_options(ByteReader& reader) {
  const auto n = reader.take<OptionNumbers>();
  DetectOptions o;
  o.table = n.table;
  o.fixed_table = TableGeometry{{n.fixed_table[0], n.fixed_table[1], n.fixed_table[2]}, n.fixed_table[3]};
  o.tolerance = n.tolerance;
  o.max_detections = n.max_detections;
  o.search_width = n.search_width;
  o.min_distance_m = n.min_distance_m;
  o.max_distance_m = n.max_distance_m;
  o.runner_up = n.runner_up;
  o.runner_up_radius_m = n.runner_up_radius_m;
  o.runner_up_angle_rad = n.runner_up_angle_rad;
  o.runner_up_most = n.runner_up_most;
  o.scoring = take_text(reader);
  o.threshold = take_maybe<double>(reader);
  o.region.image = take_maybe<std::array<double, 4>>(reader);
  o.region.workspace = take_maybe<std::array<double, 6>>(reader);
  if (const auto frame = take_maybe<TransformRows>(reader))
    o.region.workspace_from_camera = transform_of(*frame);
  return o;
}

void append_call(Bytes& bytes, const DetectCall& call, const std::vector<ObjectModel>& models) {
  for (const ObjectModel& model : models) {
    append(bytes, !call.wanted || call.wanted(model.name));
    const auto threshold = call.thresholds.find(model.name);
    append_maybe(bytes, threshold == call.thresholds.end() ? std::nullopt : std::optional(threshold->second));
  }
  append(bytes, call.further.size());
  for (const FurtherPlace& place : call.further) {
    append(bytes, place.model);
    append(bytes, place.threshold);
    append(bytes, place.taken.size());
    for (const Box2& box : place.taken) append(bytes, box);
  }
  append_maybe(bytes, call.image_region);
}

DetectCall take_call(ByteReader& reader, const std::vector<ObjectModel>& models) {
  DetectCall call;
  std::set<std::string> wanted;
  for (const ObjectModel& model : models) {
    if (reader.take<bool>()) wanted.insert(model.name);
    if (const auto threshold = take_maybe<double>(reader)) call.thresholds[model.name] = *threshold;
  }
  for (auto places = reader.take<std::size_t>(); places > 0; --places) {
    FurtherPlace& place = call.further.emplace_back();
    place.model = reader.take<std::size_t>();
    place.threshold = reader.take<double>();
    for (auto boxes = reader.take<std::size_t>(); boxes > 0; --boxes) {
      place.taken.push_back(reader.take<Box2>());
    }
  }
  call.wanted = [wanted](const std::string& name) { return wanted.count(name) > 0; };
  call.image_region = take_maybe<std::array<double, 4>>(reader);
  return call;
}

}  // namespace sextant
