// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/standing_object.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "offline/mesh/mesh_reader.h"
#include "offline/mesh/resting_poses.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using testing::HasSubstr;

MeshOptions standing(double metres_per_unit, const std::string& up) {
  MeshOptions options;
  options.metres_per_unit = metres_per_unit;
  options.up = up;
  return options;
}

// What holds for every standing object.
void expect_standing(const StandingObject& object, const std::filesystem::path& file,
                     double metres_per_unit) {
  double lowest = 1e9;
  double farthest = 0;
  for (const auto& p : object.mesh.vertices) {
    lowest = std::min(lowest, static_cast<double>(p.z()));
    farthest = std::max(farthest, p.cast<double>().norm());
  }
  EXPECT_NEAR(lowest, -object.centre_height_m, 1e-9);
  EXPECT_NEAR(farthest, object.bounding_radius_m, 1e-9);
  const Eigen::Matrix3d turn = object.object_from_mesh.linear();
  EXPECT_TRUE((turn * turn.transpose()).isIdentity(1e-9));
  EXPECT_NEAR(turn.determinant(), 1, 1e-9);
  const Mesh own = read_mesh(file, metres_per_unit);
  ASSERT_EQ(own.vertices.size(), object.mesh.vertices.size());
  for (std::size_t i = 0; i < own.vertices.size(); ++i) {
    const Eigen::Vector3d p = object.object_from_mesh * own.vertices[i].cast<double>();
    EXPECT_LT((p - object.mesh.vertices[i].cast<double>()).norm(), 1e-6);
    EXPECT_LT((turn * own.normals[i].cast<double>() - object.mesh.normals[i].cast<double>()).norm(), 1e-5);
  }
  EXPECT_EQ(object.file_hash, mesh_file_hash(file));
}

struct Bundled {
  const char* file;
  double metres_per_unit;
  const char* up;
  double height_m, radius_m;
  int symmetry_deg, geometric_symmetry_deg;
};
constexpr Bundled kBundled[] = {{"printed_box.obj", 0.001, "z", 0.210, 0.1354, 360, 180},
                                {"can.glb", 1, "y", 0.100, 0.0597, 360, 0},
                                {"bottle.ply", 0.001, "z", 0.2475, 0.1263, 360, 360},
                                {"mug.stl", 0.001, "z", 0.092, 0.0636, 360, 360}};

TEST(StandingObject, BundledMeshesStand) {
  for (const Bundled& one : kBundled) {
    const auto file = repository_file("data/meshes") / one.file;
    const StandingObject object = load_standing_object(file, standing(one.metres_per_unit, one.up));
    expect_standing(object, file, one.metres_per_unit);
    EXPECT_NEAR(object.bounding_radius_m, one.radius_m, 1e-4) << one.file;
    EXPECT_EQ(object.symmetry_deg, one.symmetry_deg) << one.file;
    EXPECT_EQ(object.geometric_symmetry_deg, one.geometric_symmetry_deg) << one.file;
    EXPECT_TRUE(object.resting_poses.empty());
    double highest = 0;
    for (const auto& p : object.mesh.vertices) highest = std::max(highest, static_cast<double>(p.z()));
    EXPECT_NEAR(highest + object.centre_height_m, one.height_m, 1e-4) << one.file;
  }
}

TEST(StandingObject, EveryRestingPoseStands) {
  for (const Bundled& one : kBundled) {
    const auto file = repository_file("data/meshes") / one.file;
    MeshOptions options;
    options.metres_per_unit = one.metres_per_unit;
    const StandingObject likeliest = load_standing_object(file, options);
    ASSERT_GE(likeliest.resting_poses.size(), 3U);
    bool stands_upright = false;
    for (std::size_t i = 0; i < likeliest.resting_poses.size(); ++i) {
      options.rest = static_cast<int>(i);
      const StandingObject object = load_standing_object(file, options);
      expect_standing(object, file, one.metres_per_unit);
      const RestingPose& pose = object.resting_poses[i];
      EXPECT_TRUE(object.object_from_mesh.linear().isApprox(pose.object_from_mesh, 1e-12));
      // It touches the table around its centre of mass: at least three corners are within 1 % of it.
      int touching = 0;
      double highest = 0;
      for (const auto& p : object.mesh.vertices) {
        touching += p.z() + object.centre_height_m < 0.01 * object.bounding_radius_m;
        highest = std::max(highest, static_cast<double>(p.z()));
      }
      EXPECT_GE(touching, 3);
      EXPECT_NEAR(highest + object.centre_height_m, pose.height_m, 0.002);
      stands_upright = stands_upright || std::abs(pose.height_m - one.height_m) < 2e-3;
      if (i == 0) {
        EXPECT_TRUE(object.object_from_mesh.isApprox(likeliest.object_from_mesh, 1e-12));
      }
    }
    EXPECT_TRUE(stands_upright) << one.file << "\n" << describe_resting_poses(likeliest.resting_poses);
  }
}

TEST(StandingObject, UpAxisIsTheFilesOwn) {
  const TemporaryFolder folder;
  const auto ply = folder.write("t.ply", tetrahedron_ply());
  const auto dae = folder.write("t.dae", tetrahedron_dae("Y_UP"));
  const std::pair<const char*, Eigen::Vector3d> axes[] = {
      {"x", Eigen::Vector3d::UnitX()},   {"y", Eigen::Vector3d::UnitY()},
      {"z", Eigen::Vector3d::UnitZ()},   {"-x", -Eigen::Vector3d::UnitX()},
      {"-y", -Eigen::Vector3d::UnitY()}, {"-z", -Eigen::Vector3d::UnitZ()}};
  for (const auto& [name, axis] : axes) {
    for (const auto& file : {ply, dae}) {
      const StandingObject object = load_standing_object(file, standing(0.1, name));
      expect_standing(object, file, 0.1);
      EXPECT_LT((object.object_from_mesh.linear() * axis - Eigen::Vector3d::UnitZ()).norm(), 1e-9) << name;
    }
  }
}

TEST(StandingObject, SymmetryCanBeSaid) {
  const auto file = repository_file("data/meshes/can.glb");
  MeshOptions options = standing(1, "y");
  for (const int said : {0, 90, 180, 360}) {
    options.symmetry_deg = said;
    const StandingObject object = load_standing_object(file, options);
    EXPECT_EQ(object.symmetry_deg, said);
    EXPECT_EQ(object.geometric_symmetry_deg, 0);
  }
  // Who says that a mug is round says so of its shape too.
  options = standing(0.001, "z");
  options.symmetry_deg = 180;
  EXPECT_EQ(load_standing_object(repository_file("data/meshes/mug.stl"), options).geometric_symmetry_deg,
            180);
}

TEST(StandingObject, AbsurdSizesSuggestTheUnit) {
  const auto error = [](const char* file, double metres_per_unit) {
    return input_error_of(
        [&] { load_standing_object(repository_file("data/meshes") / file, standing(metres_per_unit, "z")); });
  };
  EXPECT_THAT(error("mug.stl", 1), HasSubstr("if the file is in mm, give --units mm (radius 0.0636 m)"));
  EXPECT_THAT(error("can.glb", 0.001), HasSubstr("if the file is in m, give --units m (radius 0.0597 m)"));
  EXPECT_THAT(error("can.glb", 1e-9), HasSubstr("--units m"));
  EXPECT_THAT(error("bottle.ply", 1e6), HasSubstr("outside of 0.005 to 1 m"));
  const TemporaryFolder folder;
  const auto file = folder.write("t.ply", tetrahedron_ply());
  EXPECT_THAT(input_error_of([&] { load_standing_object(file, standing(100, "z")); }), HasSubstr("--units"));
}

std::string usage_error_of(const std::filesystem::path& file, const MeshOptions& options) {
  try {
    load_standing_object(file, options);
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  ADD_FAILURE() << "no UsageError";
  return "";
}

TEST(StandingObject, WrongOptionsSaySo) {
  const auto box = repository_file("data/meshes/printed_box.obj");
  MeshOptions options;
  options.metres_per_unit = 0.001;
  for (const int rest : {6, -1, 1000}) {
    options.rest = rest;
    const std::string text = usage_error_of(box, options);
    EXPECT_THAT(text, HasSubstr("6 resting poses"));
    EXPECT_THAT(text, HasSubstr("0: 35.7 %, 0.060 m high, mesh +y up; 1: "));
    EXPECT_THAT(text, HasSubstr("5: 5.3 %, 0.210 m high, mesh -z up"));
  }
  options.rest = 0;
  options.up = std::string("z");
  EXPECT_THAT(usage_error_of(box, options), HasSubstr("contradict"));
  for (const char* bad : {"w", "zz", "+z", "-", "--z", "z ", "Z"}) {
    EXPECT_THAT(usage_error_of(box, standing(0.001, bad)), HasSubstr("is no axis")) << bad;
  }
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) usage_error_of(box, standing(bad, "z"));
  options = standing(0.001, "z");
  options.symmetry_deg = 45;
  EXPECT_THAT(usage_error_of(box, options), HasSubstr("45"));
}

TEST(StandingObject, FlatThingsNeedAnUpAxis) {
  const TemporaryFolder folder;
  const auto file = folder.write("card.obj", "v 0 0 0\nv 0.1 0 0\nv 0.1 0.1 0\nv 0 0.1 0\nf 1 2 3 4\n");
  EXPECT_THAT(input_error_of([&] { load_standing_object(file, MeshOptions{}); }), HasSubstr("flat"));
  const StandingObject card = load_standing_object(file, standing(1, "z"));
  EXPECT_NEAR(card.centre_height_m, 0, 1e-9);
  EXPECT_EQ(card.geometric_symmetry_deg, 90);
}

TEST(StandingObject, SameFileSameNumbers) {
  const auto file = repository_file("data/meshes/bottle.ply");
  MeshOptions options;
  options.metres_per_unit = 0.001;
  const StandingObject a = load_standing_object(file, options);
  const StandingObject b = load_standing_object(file, options);
  EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
  EXPECT_EQ(a.object_from_mesh.matrix(), b.object_from_mesh.matrix());
  EXPECT_EQ(a.bounding_radius_m, b.bounding_radius_m);
  ASSERT_EQ(a.resting_poses.size(), b.resting_poses.size());
  for (std::size_t i = 0; i < a.resting_poses.size(); ++i) {
    EXPECT_EQ(a.resting_poses[i].probability, b.resting_poses[i].probability);
  }
}

}  // namespace
}  // namespace sextant
