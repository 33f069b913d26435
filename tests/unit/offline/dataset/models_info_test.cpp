// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/models_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/base/error.h"
#include "tests/support/random_pose.h"
#include "tests/support/real_data.h"
#include "tests/support/simple_objects.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

TEST(ModelsInfo, MeasuresABox) {
  const StandingObject object = box_object(0.03, 0.05, 0.07, 180);
  const ModelInfo info = measure_model(object);
  EXPECT_NEAR(2 * std::sqrt(0.03 * 0.03 + 0.05 * 0.05 + 0.07 * 0.07), info.diameter_m, 1e-8);
  EXPECT_TRUE(info.size_m->isApprox(Eigen::Vector3d(0.06, 0.10, 0.14), 1e-6));
  ASSERT_EQ(1U, info.discrete.size());
  EXPECT_TRUE((info.discrete[0] * Eigen::Vector3d(1, 2, 3)).isApprox(Eigen::Vector3d(-1, -2, 3), 1e-9));
  EXPECT_EQ(3U, measure_model(box_object(0.05, 0.05, 0.07, 90)).discrete.size());
  EXPECT_EQ(1U, measure_model(box_object(0.05, 0.05, 0.07, 0)).continuous.size());
  EXPECT_TRUE(measure_model(box_object(0.05, 0.05, 0.07, 360)).discrete.empty());
}

// Symmetries live in the mesh's own frame: there they map the mesh onto itself, wherever it was modelled.
TEST(ModelsInfo, SymmetriesMapTheMeshOntoItself) {
  std::mt19937_64 random(5);
  StandingObject object = box_object(0.04, 0.04, 0.09, 90);
  object.object_from_mesh = random_pose(random);
  const ModelInfo info = measure_model(object);
  const RigidTransform mesh_from_object = object.object_from_mesh.inverse();
  for (const RigidTransform& symmetry : info.discrete) {
    for (const Eigen::Vector3f& vertex : object.mesh.vertices) {
      const Eigen::Vector3d moved =
          object.object_from_mesh * symmetry * mesh_from_object * vertex.cast<double>();
      const auto closest = [&] {
        double best = 1;
        for (const Eigen::Vector3f& v : object.mesh.vertices)
          best = std::min(best, (v.cast<double>() - moved).norm());
        return best;
      }();
      EXPECT_LT(closest, 1e-7);
    }
  }
}

TEST(ModelsInfo, RoundTrips) {
  const TemporaryFolder folder;
  std::mt19937_64 random(6);
  StandingObject object = box_object(0.04, 0.04, 0.09, 90);
  object.object_from_mesh = random_pose(random);
  ModelsInfo models{{3, measure_model(object)}, {17, measure_model(box_object(0.04, 0.04, 0.09, 0))}};
  write_models_info(folder / "models_info.json", models);
  const ModelsInfo read = read_models_info(folder / "models_info.json");
  ASSERT_EQ(2U, read.size());
  for (const auto& [id, info] : models) {
    const ModelInfo& other = read.at(id);
    EXPECT_NEAR(info.diameter_m, other.diameter_m, 1e-12);
    EXPECT_TRUE(info.centre_m().isApprox(other.centre_m(), 1e-9) || info.centre_m().norm() < 1e-9);
    EXPECT_TRUE(info.up->isApprox(*other.up, 1e-12));
    EXPECT_EQ(info.symmetry_deg, other.symmetry_deg);
    EXPECT_EQ(info.geometric_symmetry_deg, other.geometric_symmetry_deg);
    ASSERT_EQ(info.discrete.size(), other.discrete.size());
    for (std::size_t i = 0; i < info.discrete.size(); ++i)
      EXPECT_TRUE(info.discrete[i].isApprox(other.discrete[i], 1e-9));
    ASSERT_EQ(info.continuous.size(), other.continuous.size());
  }
}

TEST(ModelsInfo, RefusalsNameObjectAndKey) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    write_text(folder / "m.json", text);
    try {
      read_models_info(folder / "m.json");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ("", refusal(R"({"1": {"name": "anything", "diameter": 3}})"));
  EXPECT_THAT(refusal(R"({"1": {"diameter": "x"}})"),
              testing::HasSubstr("m.json: object 1: diameter: must be a number"));
  EXPECT_THAT(refusal(R"({"1": {"min_x": 1}})"), testing::HasSubstr("\"min_y\" is missing"));
  EXPECT_THAT(refusal(R"({"1": {"symmetries_discrete": [[1,2]]}})"),
              testing::HasSubstr("symmetries_discrete[0]: must be 16"));
  EXPECT_THAT(refusal(R"({"1": {"symmetries_discrete": [[2,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]]}})"),
              testing::HasSubstr("rigid"));
  EXPECT_THAT(refusal(R"({"1": {"symmetries_continuous": [{"axis": [0,0,0], "offset": [0,0,0]}]}})"),
              testing::HasSubstr("zero"));
  EXPECT_THAT(refusal(R"({"1": {"sextant_symmetry_deg": 45}})"), testing::HasSubstr("0, 90, 180 or 360"));
}

TEST(ModelsInfo, ReadsTheRealSets) {
  SEXTANT_NEEDS_REAL_DATA(ycb, "ycbv_samples");
  const ModelsInfo models = read_models_info(ycb / "models/models_info.json");
  EXPECT_EQ(21U, models.size());
  EXPECT_NEAR(0.171972, models.at(1).diameter_m, 1e-9);
}

}  // namespace
}  // namespace sextant
