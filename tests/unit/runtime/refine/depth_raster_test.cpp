// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/depth_raster.h"

#include <gtest/gtest.h>

#include <cmath>

#include "offline/render/renderer.h"
#include "runtime/base/error.h"
#include "tests/unit/runtime/refine/refine_scene.h"

namespace sextant {
namespace {

using namespace test;

/// Two boxes through each other and a cylinder: holes, occlusion, small triangles.
ModelMesh assembly() {
  ModelMesh all;
  const auto add = [&](const ModelMesh& part, const RigidTransform& at) {
    const auto base = static_cast<std::uint32_t>(all.vertices.size());
    for (const auto& v : part.vertices) all.vertices.emplace_back((at * v.cast<double>()).cast<float>());
    for (const auto& t : part.triangles) {
      all.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    }
  };
  RigidTransform t = RigidTransform::Identity();
  add(box_mesh({0.1F, 0.03F, 0.05F}), t);
  t.rotate(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, 0.5).normalized()));
  t.translation() = Eigen::Vector3d(0.03, 0.01, 0.02);
  add(box_mesh({0.05F, 0.05F, 0.02F}), t);
  t.translation() = Eigen::Vector3d(-0.09, -0.05, 0.06);
  add(cylinder_mesh(0.03F, 0.05F), t);
  return all;
}

Mesh as_mesh(const ModelMesh& from) {
  Mesh mesh;
  mesh.vertices = from.vertices;
  mesh.normals.assign(from.vertices.size(), Eigen::Vector3f::UnitZ());
  mesh.colours.assign(from.vertices.size(), Eigen::Vector3f::Ones());
  mesh.uvs.assign(from.vertices.size(), Eigen::Vector2f::Zero());
  MeshPart part;
  part.triangles = from.triangles;
  mesh.parts = {part};
  return mesh;
}

RigidTransform random_pose(Random& random, double nearest, double farthest) {
  RigidTransform pose = RigidTransform::Identity();
  Eigen::Vector3d axis;
  for (int i = 0; i < 3; ++i) axis[i] = random.normal();
  pose.linear() = Eigen::AngleAxisd(random.uniform(0, 3), axis.normalized()).toRotationMatrix();
  const double z = random.uniform(nearest, farthest);
  const double x = random.uniform(-0.4, 0.4);
  pose.translation() = Eigen::Vector3d(x * z, random.uniform(-0.3, 0.3) * z, z);
  return pose;
}

TEST(DepthRaster, AgreesWithOpenGl) {
  std::unique_ptr<Renderer> renderer;
  try {
    renderer = std::make_unique<Renderer>();
  } catch (const DeviceError& e) {
    GTEST_SKIP() << "no EGL: " << e.what();
  }
  const ModelMesh mesh = assembly();
  const int handle = renderer->upload(as_mesh(mesh));
  Random random(4);
  DepthRaster raster;
  int compared = 0;
  int differing = 0;
  double worst = 0;
  for (int i = 0; i < 12; ++i) {
    const RigidTransform pose = random_pose(random, 0.4, 1.2);
    raster.draw(mesh, pose, kCamera);
    const RenderedView view =
        renderer->render(kCamera, {0, 0, kCamera.width, kCamera.height}, {{handle, pose}}, {}, {0, 0, 0});
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) {
        const double expected = view.ray_depth_m.at<float>(y, x);
        const double inverse = raster.inverse_depth(x, y);
        if (expected == 0 && inverse == 0) continue;
        ++compared;
        const double got = inverse > 0 ? 1 / inverse / kCamera.ray(x, y).z() : 0;
        // On silhouettes the two may decide differently; elsewhere they may not.
        if (expected == 0 || got == 0 || std::abs(got - expected) > 0.002) {
          ++differing;
        } else {
          worst = std::max(worst, std::abs(got - expected));
        }
      }
    }
  }
  std::printf("%d pixels, %d on edges differ, else at most %.3f mm\n", compared, differing, 1e3 * worst);
  EXPECT_GT(compared, 50000);
  EXPECT_LT(differing, compared / 100);
}

// The nearest intersection of the pixel's ray with all triangles, one by one (Moeller & Trumbore 1997).
TEST(DepthRaster, AgreesWithRayCasting) {
  const ModelMesh mesh = assembly();
  Random random(9);
  DepthRaster raster;
  int differing = 0;
  int covered = 0;
  for (int i = 0; i < 6; ++i) {
    const RigidTransform pose = random_pose(random, 0.3, 0.9);
    raster.draw(mesh, pose, kCamera);
    for (int k = 0; k < 1500; ++k) {
      const int x = random.integer(0, kCamera.width - 1);
      const int y = random.integer(0, kCamera.height - 1);
      const Eigen::Vector3d ray((x - kCamera.cx) / kCamera.focal, (y - kCamera.cy) / kCamera.focal, 1);
      double nearest = 0;
      for (const auto& t : mesh.triangles) {
        const Eigen::Vector3d a = pose * mesh.vertices[t[0]].cast<double>();
        const Eigen::Vector3d e1 = pose * mesh.vertices[t[1]].cast<double>() - a;
        const Eigen::Vector3d e2 = pose * mesh.vertices[t[2]].cast<double>() - a;
        const Eigen::Vector3d p = ray.cross(e2);
        const double det = e1.dot(p);
        if (std::abs(det) < 1e-14) continue;
        const double u = -a.dot(p) / det;
        const Eigen::Vector3d q = (-a).cross(e1);
        const double v = ray.dot(q) / det;
        const double z = e2.dot(q) / det;
        if (u < 0 || v < 0 || u + v > 1 || z <= 0) continue;
        if (nearest == 0 || z < nearest) nearest = z;
      }
      const double inverse = raster.inverse_depth(x, y);
      if (nearest == 0 && inverse == 0) continue;
      ++covered;
      if (nearest == 0 || inverse == 0 || std::abs(1 / inverse - nearest) > 1e-4) ++differing;
    }
  }
  EXPECT_GT(covered, 300);
  EXPECT_LE(differing, covered / 100);
}

TEST(DepthRaster, NeighboursLeaveNoCracks) {
  // A fan of thin triangles that fills a disc facing the camera.
  const ModelMesh disc = cylinder_mesh(0.1F, 0.0F, 360);
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = Eigen::Vector3d(0.0123, -0.0071, 0.6);
  DepthRaster raster;
  raster.draw(disc, pose, kCamera);
  int holes = 0;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      const Eigen::Vector3d p = kCamera.ray(x, y) * (0.6 / kCamera.ray(x, y).z());
      const double r = (p - pose.translation()).norm();
      if (r < 0.0995 && raster.triangle(x, y) == DepthRaster::kBackground) ++holes;
      if (r > 0.1005) {
        EXPECT_EQ(raster.triangle(x, y), DepthRaster::kBackground);
      }
    }
  }
  EXPECT_EQ(holes, 0);
}

TEST(DepthRaster, OutsideBehindAndAcrossTheFocalPlane) {
  const ModelMesh mesh = box_mesh({0.1F, 0.1F, 0.1F});
  DepthRaster raster;
  RigidTransform pose = RigidTransform::Identity();
  pose.translation() = Eigen::Vector3d(0, 0, -1);
  raster.draw(mesh, pose, kCamera);
  EXPECT_TRUE(raster.window().empty());
  pose.translation() = Eigen::Vector3d(4, 0, 1);
  raster.draw(mesh, pose, kCamera);
  EXPECT_TRUE(raster.window().empty());
  EXPECT_EQ(raster.triangle(10, 10), DepthRaster::kBackground);
  pose.translation() = Eigen::Vector3d(0, 0, 0.08);  // the camera is inside the box
  raster.draw(mesh, pose, kCamera);
  EXPECT_EQ(raster.triangle(-1, 0), DepthRaster::kBackground);
  EXPECT_EQ(raster.inverse_depth(640, 480), 0.0F);
}

}  // namespace
}  // namespace sextant
