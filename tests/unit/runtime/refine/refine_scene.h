// SPDX-License-Identifier: Apache-2.0
// A rigid object on a table as a real sensor would show it, made without OpenGL: the object by the
// rasteriser under test's sibling (itself tested against OpenGL), the table as a plane, noise by the sensor
// models of offline/synthesize, which are not the one that the refinement believes in.
#pragma once

#include <cmath>
#include <numbers>

#include "offline/synthesize/colour_sensor.h"
#include "offline/synthesize/depth_sensor.h"
#include "offline/synthesize/random.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/model/object_model.h"
#include "runtime/refine/depth_raster.h"
#include "runtime/refine/refiner.h"

namespace sextant::test {

inline const PinholeCamera kCamera{640, 480, 525, 319.5, 239.5};
inline constexpr double kDegree = std::numbers::pi / 180;

/// Axis-aligned box, half sizes in metres; wound outwards.
inline ModelMesh box_mesh(const Eigen::Vector3f& half) {
  ModelMesh mesh;
  for (unsigned i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1U ? 1.0F : -1.0F) * half.x(), (i & 2U ? 1.0F : -1.0F) * half.y(),
                               (i & 4U ? 1.0F : -1.0F) * half.z());
  }
  for (const auto& q : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}}) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

/// A closed upright cylinder.
inline ModelMesh cylinder_mesh(float radius, float half_height, std::uint32_t sides = 48) {
  ModelMesh mesh;
  for (std::uint32_t i = 0; i < sides; ++i) {
    const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(sides);
    mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), -half_height);
    mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), half_height);
  }
  const std::uint32_t bottom = 2 * sides;
  mesh.vertices.emplace_back(0, 0, -half_height);
  mesh.vertices.emplace_back(0, 0, half_height);
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = 2 * i;
    const std::uint32_t b = 2 * ((i + 1) % sides);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({bottom, b, a});
    mesh.triangles.push_back({bottom + 1, a + 1, b + 1});
  }
  return mesh;
}

inline ObjectModel model_of(ModelMesh mesh, double half_height, int symmetry_deg) {
  ObjectModel model;
  for (const Eigen::Vector3f& v : mesh.vertices) {
    model.bounding_radius_m = std::max(model.bounding_radius_m, static_cast<double>(v.norm()));
  }
  model.mesh = std::move(mesh);
  model.centre_height_m = half_height;
  model.symmetry_deg = model.geometric_symmetry_deg = symmetry_deg;
  return model;
}

/// Standing on the table, its centre on the ray of a pixel.
inline RigidTransform standing(const ObjectModel& model, const TableGeometry& table, double x, double y,
                               double turn_rad) {
  const Eigen::Vector3d up = table.up_in_camera;
  const Eigen::Vector3d ray = kCamera.ray(x, y);
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = ray * ((model.centre_height_m - table.camera_height_m) / up.dot(ray));
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(up).normalized() * -1;
  pose.linear().col(0) = right;
  pose.linear().col(1) = up.cross(right);
  pose.linear().col(2) = up;
  pose.linear() = pose.linear() * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
  return pose;
}

struct Scene {
  SearchFrame frame;
  cv::Mat edges;
};

/// Grey of a face by its direction, as light from the upper left would make it.
inline unsigned char grey(const Eigen::Vector3d& normal) {
  const double light = normal.dot(Eigen::Vector3d(-0.5, -0.8, -0.35));
  return static_cast<unsigned char>(std::clamp(110 + 90 * light, 20.0, 250.0));
}

/// Adds a mesh to colour and axial depth.
inline void paint(const ModelMesh& mesh, const RigidTransform& pose, cv::Mat& colour, cv::Mat& axial) {
  DepthRaster raster;
  raster.draw(mesh, pose, kCamera);
  const cv::Rect w = raster.window();
  for (int y = w.y; y < w.y + w.height; ++y) {
    for (int x = w.x; x < w.x + w.width; ++x) {
      const int t = raster.triangle(x, y);
      if (t == DepthRaster::kBackground || 1 / raster.inverse_depth(x, y) >= axial.at<float>(y, x)) continue;
      const auto& v = raster.vertices_in_camera();
      const auto& c = mesh.triangles[static_cast<std::size_t>(t)];
      const Eigen::Vector3f n = (v[c[1]] - v[c[0]]).cross(v[c[2]] - v[c[0]]).normalized();
      axial.at<float>(y, x) = 1 / raster.inverse_depth(x, y);
      const unsigned char g = grey(n.cast<double>());
      colour.at<cv::Vec3b>(y, x) = {g, g, g};
    }
  }
}

/// Meshes on a table. sensor: "none", "kinect1", ...
inline Scene make_scene(const std::vector<std::pair<const ModelMesh*, RigidTransform>>& objects,
                        const TableGeometry& table, const std::string& sensor, std::uint64_t seed) {
  cv::Mat colour(kCamera.height, kCamera.width, CV_8UC3, cv::Scalar(150, 150, 150));
  cv::Mat axial(kCamera.height, kCamera.width, CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const Eigen::Vector3d ray = kCamera.ray(x, y);
      const double d = -table.camera_height_m / table.up_in_camera.dot(ray);
      axial.at<float>(y, x) = static_cast<float>(d > 0 && d < 5 ? d * ray.z() : 5.0);
    }
  }
  for (const auto& [mesh, pose] : objects) paint(*mesh, pose, colour, axial);
  if (sensor != "none") {
    axial = apply_depth_sensor(axial, kCamera.focal, depth_sensor(sensor), seed);
    colour = apply_colour_sensor(colour, ColourSensor{}, seed + 1);
  }
  Scene scene;
  RgbdFrame frame;
  frame.colour = colour;
  frame.axial_depth_m = axial;
  frame.camera = {kCamera.width, kCamera.height, kCamera.focal, kCamera.focal, kCamera.cx, kCamera.cy, {}};
  scene.frame = rectified(frame);
  scene.edges = edges_by_direction(scene.frame.colour);
  return scene;
}

/// A pose as the lattice search leaves it: off along the line of sight and tilted.
inline RigidTransform moved(const RigidTransform& pose, Random& random, double along_m, double across_m,
                            double turn_deg) {
  RigidTransform out = pose;
  Eigen::Vector3d shift;
  for (int i = 0; i < 3; ++i) shift[i] = across_m * random.normal();
  shift += pose.translation().normalized() * along_m * random.normal();
  Eigen::Vector3d turn;
  for (int i = 0; i < 3; ++i) turn[i] = turn_deg * kDegree * random.normal();
  out.translation() += shift;
  out.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * pose.linear();
  return out;
}

}  // namespace sextant::test
