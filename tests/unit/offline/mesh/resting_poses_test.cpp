// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/resting_poses.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <random>

#include "offline/mesh/mass.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> points_of(const Mesh& mesh) {
  std::vector<Vector3d> points;
  for (const auto& p : mesh.vertices) points.push_back(p.cast<double>());
  return points;
}

std::vector<RestingPose> poses_of(const Mesh& mesh) {
  const auto hull = convex_hull(points_of(mesh));
  EXPECT_TRUE(hull);
  return resting_poses(*hull, centre_of_mass(mesh, *hull));
}

double sum_of(const std::vector<RestingPose>& poses) {
  double sum = 0;
  for (const RestingPose& pose : poses) sum += pose.probability;
  return sum;
}

void expect_well_formed(const std::vector<RestingPose>& poses) {
  ASSERT_FALSE(poses.empty());
  EXPECT_NEAR(sum_of(poses), 1, 1e-9);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_NEAR(poses[i].object_from_mesh.determinant(), 1, 1e-9);
    EXPECT_TRUE((poses[i].object_from_mesh * poses[i].object_from_mesh.transpose()).isIdentity(1e-9));
    if (i > 0) {
      EXPECT_LE(poses[i].probability, poses[i - 1].probability + 1e-5);
    }
  }
}

// Solid angle of a rectangle 2a x 2b from distance d above its middle.
double rectangle_share(double a, double b, double d) {
  return 4 * std::asin(a * b / std::sqrt((a * a + d * d) * (b * b + d * d))) / (4 * std::numbers::pi);
}

TEST(RestingPoses, ABoxHasSixWithTheSolidAnglesOfItsFaces) {
  const double x = 0.16;
  const double y = 0.06;
  const double z = 0.21;
  const auto poses = poses_of(box_mesh(x, y, z));
  expect_well_formed(poses);
  ASSERT_EQ(poses.size(), 6U);
  const double shares[] = {rectangle_share(x / 2, z / 2, y / 2), rectangle_share(y / 2, z / 2, x / 2),
                           rectangle_share(x / 2, y / 2, z / 2)};
  const Vector3d ups[] = {Vector3d::UnitY(),  -Vector3d::UnitY(), Vector3d::UnitX(),
                          -Vector3d::UnitX(), Vector3d::UnitZ(),  -Vector3d::UnitZ()};
  const double heights[] = {y, x, z};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(poses[i].probability, shares[i / 2], 1e-6);
    EXPECT_NEAR(poses[i].height_m, heights[i / 2], 1e-6);
    EXPECT_LT((up_in_mesh(poses[i]) - ups[i]).norm(), 1e-6) << i;
  }
}

TEST(RestingPoses, ACylinderHasThreeHoweverManySidesItHas) {
  for (const int sides : {16, 24, 64, 200, 720}) {
    for (const double height : {0.01, 0.05, 0.0866, 0.1, 0.3}) {
      const auto poses = poses_of(cylinder_mesh(0.033, height, sides));
      expect_well_formed(poses);
      ASSERT_EQ(poses.size(), 3U) << sides << " sides, height " << height << "\n"
                                  << describe_resting_poses(poses);
      double end = 0;
      int lying = 0;
      for (const RestingPose& pose : poses) {
        const double z = up_in_mesh(pose).z();
        if (std::abs(z) > 0.5) {
          EXPECT_NEAR(std::abs(z), 1, 1e-6);
          EXPECT_NEAR(pose.height_m, height, 1e-6);
          end = pose.probability;
        } else {
          ++lying;
          EXPECT_NEAR(z, 0, 1e-6);
          EXPECT_NEAR(pose.height_m, 0.066, 0.066 * 0.02);
        }
      }
      EXPECT_EQ(lying, 1);
      // A cone's share of the sphere.
      const double wanted = 0.5 * (1 - height / 2 / std::hypot(height / 2, 0.033));
      EXPECT_NEAR(end, wanted, 0.02 * wanted + 0.002);
    }
  }
}

TEST(RestingPoses, ABallHasOneAndAConeTwo) {
  Mesh ball;
  std::mt19937_64 random(31);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3000; ++i) {
    ball.vertices.emplace_back(
        Vector3d(normal(random), normal(random), normal(random)).normalized().cast<float>());
  }
  auto hull = convex_hull(points_of(ball));
  auto poses = resting_poses(*hull, solid_of(*hull).centre);
  expect_well_formed(poses);
  EXPECT_EQ(poses.size(), 1U);

  Mesh cone;
  cone.vertices.emplace_back(0, 0, 1.2F);
  for (int i = 0; i < 90; ++i) {
    const double turn = 2 * std::numbers::pi * i / 90;
    cone.vertices.emplace_back(Vector3d(0.5 * std::cos(turn), 0.5 * std::sin(turn), 0).cast<float>());
  }
  hull = convex_hull(points_of(cone));
  poses = resting_poses(*hull, solid_of(*hull).centre);
  expect_well_formed(poses);
  ASSERT_EQ(poses.size(), 2U);
}

TEST(RestingPoses, AnUnstableFaceHandsItsShareOn) {
  // A prism that leans towards +x: it can stand on neither end, and falls from the lower one onto its +x
  // side, from the upper one onto its -x side. Front and back keep what they have.
  Mesh mesh = box_mesh(0.1, 0.1, 0.4);
  for (auto& p : mesh.vertices) {
    p.x() += 0.6F * p.z();
  }
  const auto poses = poses_of(mesh);
  expect_well_formed(poses);
  ASSERT_EQ(poses.size(), 4U);
  // The share of a front side, by rays from the middle.
  std::mt19937_64 random(35);
  std::normal_distribution<double> normal;
  int front = 0;
  constexpr int kRays = 400'000;
  for (int i = 0; i < kRays; ++i) {
    const Vector3d ray(normal(random), normal(random), normal(random));
    const Vector3d hit = ray * (0.05 / std::abs(ray.y()));  // on one of the planes of front and back
    front += std::abs(hit.z()) < 0.2 && std::abs(hit.x() - 0.6 * hit.z()) < 0.05;
  }
  const double front_share = 0.5 * front / kRays;
  for (const RestingPose& pose : poses) {
    const Vector3d up = up_in_mesh(pose);
    EXPECT_LT(std::abs(up.z()), 0.9);
    const bool is_front = std::abs(up.y()) > 0.9;
    EXPECT_NEAR(pose.probability, is_front ? front_share : 0.5 - front_share, 0.003);
  }
}

TEST(RestingPoses, AMugStandsAndLiesOnEitherSideOfItsHandle) {
  const Mesh mug = joined(cylinder_mesh(0.04, 0.09, 72), moved(box_mesh(0.03, 0.012, 0.05), {0.054, 0, 0}));
  const auto poses = poses_of(mug);
  expect_well_formed(poses);
  EXPECT_EQ(poses.size(), 4U) << describe_resting_poses(poses);
}

// Potential of the centre of mass: height above the table when direction u is down.
double height_of(const std::vector<Vector3d>& points, const Vector3d& mass, const Vector3d& down) {
  double most = -1e9;
  for (const Vector3d& p : points) most = std::max(most, down.dot(p - mass));
  return most;
}

std::vector<Vector3d> random_solid(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vector3d> points;
  for (int i = 0; i < 14; ++i) {
    const Vector3d d = Vector3d(normal(random), normal(random), normal(random)).normalized();
    points.emplace_back(Vector3d(1, 0.8, 1.3).cwiseProduct(d));
  }
  return points;
}

double angle_to_nearest(const std::vector<RestingPose>& poses, const Vector3d& down) {
  double closest = 10;
  for (const RestingPose& pose : poses) {
    closest = std::min(closest, std::acos(std::clamp(-down.dot(up_in_mesh(pose)), -1.0, 1.0)));
  }
  return closest;
}

// The oracle: any three corners on which the solid can stand, by trying all triples: all others lie above
// their plane, and the centre of mass above their triangle.
std::vector<Vector3d> stable_directions(const std::vector<Vector3d>& points, const Vector3d& mass,
                                        double least_depth) {
  std::vector<Vector3d> downs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        Vector3d down = (points[j] - points[i]).cross(points[k] - points[i]).normalized();
        if (down.dot(mass - points[i]) > 0) down = -down;
        const bool supports = std::all_of(points.begin(), points.end(),
                                          [&](const Vector3d& p) { return down.dot(p - points[i]) < 1e-12; });
        if (!supports) continue;
        const auto side = [&](const Vector3d& a, const Vector3d& b) {
          return down.dot((b - a).cross(mass - a));
        };
        const double s0 = side(points[i], points[j]);
        const double s1 = side(points[j], points[k]);
        const double s2 = side(points[k], points[i]);
        if (!((s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0))) continue;
        // How far the centre of mass is from the closest edge, and how much it rises to get over it.
        const double height = down.dot(points[i] - mass);
        const double margin = std::min({std::abs(s0) / (points[j] - points[i]).norm(),
                                        std::abs(s1) / (points[k] - points[j]).norm(),
                                        std::abs(s2) / (points[i] - points[k]).norm()});
        if (std::hypot(height, margin) - height >= least_depth) downs.push_back(down);
      }
    }
  }
  return downs;
}

TEST(RestingPoses, OfRandomSolidsAreTheTriplesTheyCanStandOn) {
  std::mt19937_64 random(32);
  for (int solid = 0; solid < 200; ++solid) {
    const std::vector<Vector3d> points = random_solid(random);
    const auto hull = convex_hull(points);
    const Vector3d mass = solid_of(*hull).centre;
    const auto poses = resting_poses(*hull, mass, 0);
    expect_well_formed(poses);
    // One pose stands for all within 5 deg of it; a valley shallower than faces are flat (1 deg) may go.
    for (const Vector3d& down : stable_directions(points, mass, 0.005)) {
      EXPECT_LT(angle_to_nearest(poses, down), 5.1 * std::numbers::pi / 180);
    }
    const std::vector<Vector3d> wanted = stable_directions(points, mass, 0);
    for (const RestingPose& pose : poses) {
      const Vector3d down = -up_in_mesh(pose);
      const bool found = std::any_of(wanted.begin(), wanted.end(), [&](const Vector3d& w) {
        return std::acos(std::min(1.0, w.dot(down))) < 1.1 * std::numbers::pi / 180;
      });
      EXPECT_TRUE(found) << solid << "\n" << describe_resting_poses(poses);
      EXPECT_NEAR(pose.height_m, height_of(points, mass, down) + height_of(points, mass, -down), 1e-9);
    }
  }
}

// The lowest pass from one orientation to any lower listed one, over a grid of orientations: how much the
// centre of mass must rise on the way. Above the true rise by less than `kGridError`.
constexpr double kGridError = 0.008;

double least_rise(const std::vector<Vector3d>& points, const Vector3d& mass, const Vector3d& from,
                  const std::vector<Vector3d>& to) {
  constexpr int kRows = 240;
  constexpr int kColumns = 480;
  const auto node_of = [](const Vector3d& d) {
    const int row = std::min(
        kRows - 1, static_cast<int>(std::acos(std::clamp(d.z(), -1.0, 1.0)) / std::numbers::pi * kRows));
    const double turn = std::atan2(d.y(), d.x()) / (2 * std::numbers::pi);
    return row * kColumns + static_cast<int>((turn < 0 ? turn + 1 : turn) * kColumns) % kColumns;
  };
  const auto direction_of = [](int node) {
    const double polar = std::numbers::pi * (node / kColumns + 0.5) / kRows;
    const double turn = 2 * std::numbers::pi * (node % kColumns + 0.5) / kColumns;
    return Vector3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
  };
  std::vector<bool> target(kRows * kColumns, false);
  for (const Vector3d& d : to) target[static_cast<std::size_t>(node_of(d))] = true;
  std::vector<bool> seen(target.size(), false);
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> queue;
  queue.push({height_of(points, mass, from), node_of(from)});
  while (!queue.empty()) {
    const auto [height, node] = queue.top();
    queue.pop();
    if (seen[static_cast<std::size_t>(node)]) continue;
    seen[static_cast<std::size_t>(node)] = true;
    if (target[static_cast<std::size_t>(node)]) return height - height_of(points, mass, from);
    const int row = node / kColumns;
    const int column = node % kColumns;
    std::vector<int> next{row * kColumns + (column + 1) % kColumns,
                          row * kColumns + (column + kColumns - 1) % kColumns};
    next.push_back(row > 0 ? node - kColumns : (column + kColumns / 2) % kColumns);  // over the pole
    next.push_back(row < kRows - 1 ? node + kColumns : row * kColumns + (column + kColumns / 2) % kColumns);
    for (const int n : next) queue.push({std::max(height, height_of(points, mass, direction_of(n))), n});
  }
  return HUGE_VAL;
}

// Which of all minima the allowance for knocks removes: exactly those with a low pass to a lower one.
TEST(RestingPoses, OnlyShallowPosesAreLeftOut) {
  std::mt19937_64 random(34);
  int left_out = 0;
  int kept = 0;
  for (int solid = 0; solid < 12; ++solid) {
    const std::vector<Vector3d> points = random_solid(random);
    const auto hull = convex_hull(points);
    const Vector3d mass = solid_of(*hull).centre;
    double radius = 0;
    for (const Vector3d& p : points) radius = std::max(radius, (p - mass).norm());
    constexpr double kRattle = 0.02;
    const auto all = resting_poses(*hull, mass, 0);
    const auto deep = resting_poses(*hull, mass, kRattle);
    expect_well_formed(deep);
    for (const RestingPose& pose : all) {
      const Vector3d down = -up_in_mesh(pose);
      // What stands for several equally low ones may be any of them.
      const bool is_kept = angle_to_nearest(deep, down) < 1e-6;
      if (!is_kept && angle_to_nearest(deep, down) < 5.1 * std::numbers::pi / 180) continue;
      const double level = is_kept ? -1e-9 : 1.1e-3 * radius;
      std::vector<Vector3d> lower;
      for (const RestingPose& other : all) {
        const Vector3d there = -up_in_mesh(other);
        if (there.dot(down) > 1 - 1e-9) continue;
        if (height_of(points, mass, there) < height_of(points, mass, down) + level) lower.push_back(there);
      }
      const double rise = lower.empty() ? HUGE_VAL : least_rise(points, mass, down, lower);
      if (is_kept) {
        ++kept;
        EXPECT_GE(rise, kRattle * radius - 1.1e-3 * radius);
      } else {
        ++left_out;
        EXPECT_LE(rise, kRattle * radius + kGridError);
      }
    }
  }
  EXPECT_GT(left_out, 3);
  EXPECT_GT(kept, 20);
}

TEST(RestingPoses, TurnWithTheMesh) {
  const Mesh mesh = joined(box_mesh(0.1, 0.2, 0.3), moved(box_mesh(0.1, 0.05, 0.05), {0.1, 0, 0.1}));
  const auto before = poses_of(mesh);
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.2, 0.7, -0.4, 0.5).normalized();
  Mesh turned = mesh;
  for (auto& p : turned.vertices) p = (turn * p.cast<double>()).cast<float>();
  const auto after = poses_of(turned);
  ASSERT_EQ(before.size(), after.size());
  for (const RestingPose& pose : before) {
    const bool found = std::any_of(after.begin(), after.end(), [&](const RestingPose& other) {
      return (turn * up_in_mesh(pose) - up_in_mesh(other)).norm() < 1e-4 &&
             std::abs(pose.probability - other.probability) < 1e-4 &&
             std::abs(pose.height_m - other.height_m) < 1e-5;
    });
    EXPECT_TRUE(found) << describe_resting_poses(before) << describe_resting_poses(after);
  }
}

TEST(RestingPoses, RaisingIsTheShortestTurn) {
  EXPECT_TRUE(rotation_that_raises(Vector3d::UnitZ()).isIdentity(1e-12));
  std::mt19937_64 random(33);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Vector3d up = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Eigen::Matrix3d turn = rotation_that_raises(up);
    EXPECT_LT((turn * up - Vector3d::UnitZ()).norm(), 1e-9);
    EXPECT_NEAR(turn.determinant(), 1, 1e-9);
    EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), std::acos(up.z()), 1e-6);
  }
  const Eigen::Matrix3d over = rotation_that_raises(-Vector3d::UnitZ());
  EXPECT_LT((over * -Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_NEAR(over.determinant(), 1, 1e-12);
}

TEST(RestingPoses, DescriptionIsOneLineEach) {
  const std::string text = describe_resting_poses(poses_of(box_mesh(0.16, 0.06, 0.21)));
  EXPECT_THAT(text, testing::StartsWith(
                        "0: 35.7 %, 0.060 m high, mesh +y up\n1: 35.7 %, 0.060 m high, mesh -y up\n"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 6);
}

}  // namespace
}  // namespace sextant
