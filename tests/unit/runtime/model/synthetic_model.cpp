// SPDX-License-Identifier: Apache-2.0
#include "synthetic_model.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace sextant::test {
namespace {

constexpr double kRadians = std::numbers::pi / 180;
const Eigen::Vector3d kHalf(0.08, 0.03, 0.105);

using Angles = std::array<double, 3>;
using OfRotation = std::function<double(const Eigen::Matrix3d&)>;

/// First-order form of a quantity around the centre.
std::array<float, 4> linearised(const OfRotation& quantity, const Angles& centre) {
  constexpr double kStep = 1e-5;
  const auto at = [&](const Angles& a) { return quantity(tangent_from_object(a[0], a[1], a[2])); };
  std::array<float, 4> form{};
  double constant = at(centre);
  for (std::size_t i = 0; i < 3; ++i) {
    Angles more = centre;
    Angles less = centre;
    more[i] += kStep;
    less[i] -= kStep;
    const double slope = (at(more) - at(less)) / (2 * kStep);
    form[i + 1] = static_cast<float>(slope);
    constant -= slope * centre[i];
  }
  form[0] = static_cast<float>(constant);
  return form;
}

/// Depth of the box's nearest surface along forward at (px, py), relative to its centre; infinity beside it.
double surface_depth(const Eigen::Matrix3d& rotation, double px, double py) {
  const Eigen::Vector3d origin = rotation.transpose() * Eigen::Vector3d(px, py, 0);
  const Eigen::Vector3d direction = rotation.transpose() * Eigen::Vector3d::UnitZ();
  double enters = -INFINITY;
  double leaves = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const double a = (-kHalf(i) - origin(i)) / direction(i);
    const double b = (kHalf(i) - origin(i)) / direction(i);
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters < leaves ? enters : INFINITY;
}

/// A point on a visible edge of the box, and the edge's axis.
std::pair<Eigen::Vector3d, int> point_on_visible_edge(const Eigen::Matrix3d& rotation,
                                                      std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  for (;;) {
    const int axis = static_cast<int>(random() % 3);
    Eigen::Vector3d point;
    bool visible = false;
    for (int i = 0; i < 3; ++i) {
      const double side = (random() & 1U) != 0 ? 1 : -1;
      point(i) = kHalf(i) * (i == axis ? unit(random) : side);
      visible = visible || (i != axis && side * rotation(2, i) < 0);
    }
    if (visible) return {point, axis};
  }
}

PartStatistics statistics(std::mt19937_64& random) {
  const auto unit = [&] { return static_cast<float>(random() % 1000) / 1000; };
  return {1e-6F * (1 + 100 * unit()), 0.5F + 0.45F * unit(), 0.05F + 0.4F * unit(), 0.25F + 2 * unit()};
}

VisualPart edge_part(const Angles& centre, std::mt19937_64& random) {
  const Eigen::Matrix3d rotation = tangent_from_object(centre[0], centre[1], centre[2]);
  const auto [point, axis] = point_on_visible_edge(rotation, random);
  const Eigen::Vector3d p = point;
  VisualPart part;
  part.u = linearised([&](const Eigen::Matrix3d& r) { return r.row(0).dot(p); }, centre);
  part.v = linearised([&](const Eigen::Matrix3d& r) { return r.row(1).dot(p); }, centre);
  const double angle = std::atan2(rotation(1, axis), rotation(0, axis)) / kRadians;
  part.kind = static_cast<std::uint8_t>((std::lround(angle / 22.5) + 16) % 8);
  part.variance = static_cast<float>(1e-6 * (1 + static_cast<double>(random() % 1000)));
  part.radius = static_cast<float>(5.0 / 525);
  part.seen = statistics(random);
  return part;
}

DepthPart depth_part(const Angles& centre, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-0.13, 0.13);
  const Eigen::Matrix3d rotation = tangent_from_object(centre[0], centre[1], centre[2]);
  for (;;) {
    const double px = unit(random);
    const double py = unit(random);
    if (std::isinf(surface_depth(rotation, px, py))) continue;
    DepthPart part;
    part.px = static_cast<float>(px);
    part.py = static_cast<float>(py);
    part.d = linearised([&](const Eigen::Matrix3d& r) { return surface_depth(r, px, py); }, centre);
    if (!std::isfinite(part.d[0])) continue;
    part.variance = static_cast<float>(1e-6 * (1 + static_cast<double>(random() % 1000)));
    part.radius = 0.02F;
    part.missing = 0.01F;
    part.seen = statistics(random);
    part.role = static_cast<DepthRole>(random() % 3);
    // Beside an edge the difference quotient may cross it: not a part.
    if (std::abs(part.d[1]) + std::abs(part.d[2]) + std::abs(part.d[3]) < 1) return part;
  }
}

ModelMesh box_mesh() {
  ModelMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1U ? 1 : -1, i & 2U ? 1 : -1, i & 4U ? 1 : -1);
    mesh.vertices.push_back(corner.cwiseProduct(kHalf).cast<float>());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

void describe(ObjectModel& model, std::uint64_t seed) {
  model.object_id = 7;
  model.symmetry_deg = 360;
  model.geometric_symmetry_deg = 180;
  model.object_from_mesh.linear() =
      Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  model.object_from_mesh.translation() = Eigen::Vector3d(0.01, -0.02, 0.3);
  model.provenance = {"sextant 0.1.0", "box.ply", 0x0123456789abcdefU, seed, "{images: 100, parts: 100}"};
}

}  // namespace

Eigen::Matrix3d tangent_from_object(double rx, double ry, double rz) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Eigen::Matrix3d upright = (Eigen::Matrix3d() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished();
  return AngleAxisd(rx, Vector3d::UnitZ()).toRotationMatrix() *
         AngleAxisd(-ry, Vector3d::UnitX()).toRotationMatrix() * upright *
         AngleAxisd(rz, Vector3d::UnitZ()).toRotationMatrix();
}

ObjectModel make_box_model(int turntable_bins, int parts, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ObjectModel model;
  describe(model, seed);
  model.name = "box";
  model.bounding_radius_m = kHalf.norm();
  model.centre_height_m = kHalf.z();
  for (int rz = 0; rz < 20 * turntable_bins; rz += 20) {
    for (int ry = -60; ry < -20; ry += 20) {
      ViewpointBin bin;
      bin.box = {{-10, ry, rz}, {10, ry + 20, rz + 20}};
      const Angles centre{0, (ry + 10) * kRadians, (rz + 10) * kRadians};
      for (int k = 0; k < parts; ++k) bin.visual.push_back(edge_part(centre, random));
      for (int k = 0; k < parts; ++k) bin.depth.push_back(depth_part(centre, random));
      const auto r = static_cast<float>(model.bounding_radius_m);
      bin.extent = {-r, -r, r, r};
      model.bins.push_back(bin);
    }
  }
  model.mesh = box_mesh();
  model.marks = {{{0.08F, 0.01F, 0.05F}, {0, 1, 0}, {1, 0, 0}},
                 {{0, -0.03F, -0.1F}, {0.6F, 0, 0.8F}, {0, -1, 0}}};
  model.confidence.weights = {-8, 5, 2.5F, 6, 0, 0.25F, 1, 3};
  model.confidence.calibrated = true;
  model.confidence.false_confidences = {0.75F, 0.5F, 0.125F};
  model.confidence.images = 40;
  return model;
}

ObjectModel make_random_model(int bins, int parts, double radius_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  ObjectModel model;
  describe(model, seed);
  model.name = "random";
  model.bounding_radius_m = radius_m;
  model.centre_height_m = radius_m / 2;
  for (int b = 0; b < bins; ++b) {
    ViewpointBin bin;
    std::array<double, 3> centre{};
    std::array<double, 3> half{};
    for (std::size_t i = 0; i < 3; ++i) {
      const int width = 10 + static_cast<int>(random() % 81);
      bin.box.lo_deg[i] = -180 + static_cast<int>(random() % static_cast<unsigned>(541 - width));
      bin.box.hi_deg[i] = bin.box.lo_deg[i] + width;
      centre[i] = (bin.box.lo_deg[i] + bin.box.hi_deg[i]) * kRadians / 2;
      half[i] = width * kRadians / 2;
    }
    const auto form = [&] {
      std::array<float, 4> f{};
      double constant = unit(random) * radius_m;
      const Eigen::Vector3d share = Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
      for (std::size_t i = 0; i < 3; ++i) {
        const double spread = share(static_cast<Eigen::Index>(i)) * radius_m;
        f[i + 1] = static_cast<float>(spread * std::numbers::sqrt3 / half[i]);
        constant -= f[i + 1] * centre[i];
      }
      f[0] = static_cast<float>(constant);
      return f;
    };
    const auto positive = [&] { return static_cast<float>(std::exp2(-24 + 12 * unit(random))); };
    for (int k = 0; k < parts; ++k) {
      bin.visual.push_back({static_cast<std::uint8_t>(random() % 8), form(), form(), positive(), positive(),
                            statistics(random)});
      DepthPart depth{static_cast<float>(unit(random) * radius_m),
                      static_cast<float>(unit(random) * radius_m),
                      form(),
                      positive(),
                      positive(),
                      0,
                      statistics(random),
                      static_cast<DepthRole>(k % 3)};
      if (k % 3 != 0) depth.missing = depth.radius * static_cast<float>(0.5 + 0.5 * std::abs(unit(random)));
      bin.depth.push_back(depth);
    }
    const auto r = static_cast<float>(radius_m);
    bin.extent = {-r, -0.7F * r, 0.9F * r, r};
    model.bins.push_back(bin);
  }
  model.mesh = box_mesh();
  for (auto& vertex : model.mesh.vertices) vertex *= static_cast<float>(radius_m / kHalf.norm());
  return model;
}

}  // namespace sextant::test
