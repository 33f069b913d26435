// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/models_info.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hal/image/file_bytes.h"
#include "hal/playback/json_file.h"
#include "hal/playback/rotation_input.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

/// Largest distance of two points, exact for the extreme points of 2000 directions spread over the sphere
/// (their hull misses less than 0.1 % of a diameter).
double diameter_of(const std::vector<Eigen::Vector3d>& points) {
  constexpr int kDirections = 2000;
  std::vector<std::size_t> extremes;
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2.0 * i + 1) / kDirections;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const Eigen::Vector3d direction(r * std::cos(angle), r * std::sin(angle), z);
    const auto farther = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return a.dot(direction) < b.dot(direction);
    };
    extremes.push_back(
        static_cast<std::size_t>(std::max_element(points.begin(), points.end(), farther) - points.begin()));
  }
  std::sort(extremes.begin(), extremes.end());
  extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
  double largest = 0;
  for (const std::size_t a : extremes) {
    for (const std::size_t b : extremes) largest = std::max(largest, (points[a] - points[b]).squaredNorm());
  }
  return std::sqrt(largest);
}

Json numbers(const Eigen::Vector3d& v, double factor) {
  return {v.x() * factor, v.y() * factor, v.z() * factor};
}

Json matrix_mm(const RigidTransform& t) {
  Json values = Json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      values.push_back(t.matrix()(row, column) * (column == 3 && row < 3 ? 1000.0 : 1.0));
    }
  }
  return values;
}

Eigen::Vector3d vector_of(const JsonView& view) {
  const std::vector<double> v = view.numbers(3);
  return {v[0], v[1], v[2]};
}

Eigen::Vector3d unit_vector_of(const JsonView& view) {
  const Eigen::Vector3d v = vector_of(view);
  if (!(v.norm() > 1e-6)) view.refuse("must not be zero");
  return v.normalized();
}

std::optional<Eigen::Vector3d> vector_mm(const JsonView& entry, const std::string& prefix) {
  if (!entry.find(prefix + "x")) return std::nullopt;
  Eigen::Vector3d v;
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) v[i] = entry.at(prefix + axes[i]).number(-1e6, 1e6) / 1000.0;
  return v;
}

std::optional<int> symmetry_of(const JsonView& entry, const char* key) {
  const auto view = entry.find(key);
  if (!view) return std::nullopt;
  const int degrees = view->integer(0, 360);
  if (degrees != 0 && degrees != 90 && degrees != 180 && degrees != 360)
    view->refuse("must be 0, 90, 180 or 360");
  return degrees;
}

ModelInfo read_model(const JsonView& entry) {
  ModelInfo info;
  if (const auto view = entry.find("diameter")) info.diameter_m = view->number(0, 1e6) / 1000.0;
  info.min_m = vector_mm(entry, "min_");
  info.size_m = vector_mm(entry, "size_");
  if (const auto list = entry.find("symmetries_continuous")) {
    for (const JsonView& element : list->elements()) {
      info.continuous.push_back(
          {unit_vector_of(element.at("axis")), vector_of(element.at("offset")) / 1000.0});
    }
  }
  if (const auto list = entry.find("symmetries_discrete")) {
    for (const JsonView& element : list->elements()) {
      const std::vector<double> m = element.numbers(16);
      const auto rotation =
          rotation_from_rounded(std::vector<double>{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]});
      if (!rotation) element.refuse("is not a rigid 4x4 transform");
      RigidTransform t = RigidTransform::Identity();
      t.linear() = *rotation;
      t.translation() = Eigen::Vector3d(m[3], m[7], m[11]) / 1000.0;
      info.discrete.push_back(t);
    }
  }
  if (const auto view = entry.find("sextant_up")) info.up = unit_vector_of(*view);
  info.symmetry_deg = symmetry_of(entry, "sextant_symmetry_deg");
  info.geometric_symmetry_deg = symmetry_of(entry, "sextant_geometric_symmetry_deg");
  return info;
}

Json to_json(const ModelInfo& info) {
  Json entry;
  entry["diameter"] = info.diameter_m * 1000;
  const char* axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3 && info.min_m; ++i) entry[std::string("min_") + axes[i]] = (*info.min_m)[i] * 1000;
  for (int i = 0; i < 3 && info.size_m; ++i) entry[std::string("size_") + axes[i]] = (*info.size_m)[i] * 1000;
  for (const AxialSymmetry& s : info.continuous) {
    entry["symmetries_continuous"].push_back(
        Json{{"axis", numbers(s.axis, 1)}, {"offset", numbers(s.offset_m, 1000)}});
  }
  for (const RigidTransform& t : info.discrete) entry["symmetries_discrete"].push_back(matrix_mm(t));
  if (info.up) entry["sextant_up"] = numbers(*info.up, 1);
  if (info.symmetry_deg) entry["sextant_symmetry_deg"] = *info.symmetry_deg;
  if (info.geometric_symmetry_deg) entry["sextant_geometric_symmetry_deg"] = *info.geometric_symmetry_deg;
  return entry;
}

}  // namespace

Eigen::Vector3d ModelInfo::centre_m() const {
  return min_m && size_m ? Eigen::Vector3d(*min_m + *size_m / 2) : Eigen::Vector3d::Zero();
}

ModelInfo measure_model(const StandingObject& object) {
  const RigidTransform mesh_from_object = object.object_from_mesh.inverse();
  std::vector<Eigen::Vector3d> points;
  points.reserve(object.mesh.vertices.size());
  for (const Eigen::Vector3f& v : object.mesh.vertices)
    points.emplace_back(mesh_from_object * v.cast<double>());
  ModelInfo info;
  info.diameter_m = diameter_of(points);
  Eigen::Vector3d lo = points.front();
  Eigen::Vector3d hi = points.front();
  for (const Eigen::Vector3d& p : points) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  info.min_m = lo;
  info.size_m = hi - lo;
  const Eigen::Vector3d up = mesh_from_object.linear().col(2);
  const Eigen::Vector3d centre = mesh_from_object.translation();
  info.up = up;
  info.symmetry_deg = object.symmetry_deg;
  info.geometric_symmetry_deg = object.geometric_symmetry_deg;
  if (object.symmetry_deg == 0) info.continuous.push_back({up, centre});
  for (int turn = object.symmetry_deg; turn > 0 && turn < 360; turn += object.symmetry_deg) {
    const Eigen::AngleAxisd rotation(turn * std::numbers::pi / 180, up);
    info.discrete.emplace_back(Eigen::Translation3d(centre) * rotation * Eigen::Translation3d(-centre));
  }
  return info;
}

ModelsInfo read_models_info(const std::filesystem::path& file) {
  const nlohmann::json json = read_json_file(file);
  const JsonView root(json, file.string());
  ModelsInfo models;
  for (const int id : root.number_keys())
    models[id] = read_model(root.at(std::to_string(id), "object " + std::to_string(id)));
  return models;
}

void write_models_info(const std::filesystem::path& file, const ModelsInfo& models) {
  Json json = Json::object();
  for (const auto& [id, info] : models) json[std::to_string(id)] = to_json(info);
  const std::string text = json.dump(1) + "\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

}  // namespace sextant
