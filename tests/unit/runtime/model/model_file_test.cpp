// SPDX-License-Identifier: Apache-2.0
// What goes into a model file comes out again: losses far below the noise, sizes, files on disk.
#include "runtime/model/model_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "runtime/base/error.h"
#include "runtime/model/model_check.h"
#include "synthetic_model.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
constexpr double kRadians = std::numbers::pi / 180;

/// A folder of this test alone, gone afterwards.
class ModelFileOnDisk : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sextant-model-test-" + std::to_string(::getpid()) + "-" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

double value_at(const std::array<float, 4>& form, const std::array<double, 3>& r) {
  return form[0] + form[1] * r[0] + form[2] * r[1] + form[3] * r[2];
}

/// Losses over random rotations of each bin: pixels of a camera of 525 px at 0.5 m, metres, relative
/// variance.
struct Losses {
  double position_px = 0, depth_m = 0, variance = 0, vertex_m = 0;
};

Losses losses(const ObjectModel& a, const ObjectModel& b) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  Losses worst;
  const auto position = [&](double x, double y) {
    worst.position_px = std::max(worst.position_px, std::abs(x - y) * 525 / 0.5);
  };
  const auto relative = [&](double x, double y) {
    worst.variance = std::max(worst.variance, std::abs(y / x - 1));
  };
  const auto statistics = [&](const PartStatistics& x, const PartStatistics& y) {
    relative(x.spread, y.spread);
    relative(x.weight, y.weight);
    EXPECT_NEAR(x.found, y.found, 0.5 / 255 + 1e-6);
    EXPECT_NEAR(x.background, y.background, 0.5 / 255 + 1e-6);
  };
  for (std::size_t i = 0; i < a.bins.size(); ++i) {
    for (int sample = 0; sample < 20; ++sample) {
      std::array<double, 3> r{};
      for (std::size_t k = 0; k < 3; ++k) {
        const RotationBox& box = a.bins[i].box;
        r[k] = (box.lo_deg[k] + unit(random) * (box.hi_deg[k] - box.lo_deg[k])) * kRadians;
      }
      for (std::size_t k = 0; k < a.bins[i].visual.size(); ++k) {
        const VisualPart& p = a.bins[i].visual[k];
        const VisualPart& q = b.bins[i].visual[k];
        position(value_at(p.u, r), value_at(q.u, r));
        position(value_at(p.v, r), value_at(q.v, r));
        relative(p.variance, q.variance);
        relative(p.radius, q.radius);
        statistics(p.seen, q.seen);
        EXPECT_EQ(p.kind, q.kind);
      }
      for (std::size_t k = 0; k < a.bins[i].depth.size(); ++k) {
        const DepthPart& p = a.bins[i].depth[k];
        const DepthPart& q = b.bins[i].depth[k];
        position(p.px, q.px);
        position(p.py, q.py);
        worst.depth_m = std::max(worst.depth_m, std::abs(value_at(p.d, r) - value_at(q.d, r)));
        relative(p.variance, q.variance);
        relative(p.radius, q.radius);
        statistics(p.seen, q.seen);
        EXPECT_EQ(p.role, q.role);
        if (p.missing == 0) {
          EXPECT_EQ(q.missing, 0);
        } else {
          relative(p.missing, q.missing);
        }
      }
    }
  }
  for (std::size_t i = 0; i < a.mesh.vertices.size(); ++i) {
    const double off = (a.mesh.vertices[i] - b.mesh.vertices[i]).cwiseAbs().maxCoeff();
    worst.vertex_m = std::max(worst.vertex_m, off);
  }
  return worst;
}

TEST(ModelFile, LosesFarLessThanTheNoise) {
  const ObjectModel box = test::make_box_model(18, 100, 1);
  const ObjectModel wild = test::make_random_model(100, 60, 0.25, 2);
  for (const ObjectModel& model : {box, wild}) {
    const Losses loss = losses(model, decode_model(encode_model(model), "memory"));
    EXPECT_LT(loss.position_px, 0.05);
    EXPECT_LT(loss.depth_m, 1e-4);
    EXPECT_LT(loss.variance, 1e-3);
    EXPECT_LT(loss.vertex_m, 1e-5);
    RecordProperty(model.name + "_position_px", std::to_string(loss.position_px));
    std::printf("%s: %.4f px, %.4f mm, %.4f %%, vertices %.4f mm\n", model.name.c_str(), loss.position_px,
                loss.depth_m * 1e3, loss.variance * 100, loss.vertex_m * 1e3);
  }
}

TEST(ModelFile, KeepsWhatIsNotQuantisedExactly) {
  const ObjectModel model = test::make_box_model(2, 5, 3);
  const ObjectModel back = decode_model(encode_model(model), "memory");
  EXPECT_EQ(back.name, model.name);
  EXPECT_EQ(back.object_id, model.object_id);
  EXPECT_EQ(back.symmetry_deg, model.symmetry_deg);
  EXPECT_EQ(back.geometric_symmetry_deg, model.geometric_symmetry_deg);
  EXPECT_EQ(back.bounding_radius_m, model.bounding_radius_m);
  EXPECT_EQ(back.centre_height_m, model.centre_height_m);
  EXPECT_EQ(back.object_from_mesh.matrix(), model.object_from_mesh.matrix());
  EXPECT_EQ(back.provenance.program_version, model.provenance.program_version);
  EXPECT_EQ(back.provenance.mesh_name, model.provenance.mesh_name);
  EXPECT_EQ(back.provenance.mesh_hash, model.provenance.mesh_hash);
  EXPECT_EQ(back.provenance.seed, model.provenance.seed);
  EXPECT_EQ(back.provenance.parameters, model.provenance.parameters);
  EXPECT_EQ(back.mesh.triangles, model.mesh.triangles);
  EXPECT_EQ(back.confidence.weights, model.confidence.weights);
  EXPECT_EQ(back.confidence.calibrated, model.confidence.calibrated);
  EXPECT_EQ(back.confidence.false_confidences, model.confidence.false_confidences);
  EXPECT_EQ(back.confidence.images, model.confidence.images);
  ASSERT_EQ(back.bins.size(), model.bins.size());
  for (std::size_t i = 0; i < back.bins.size(); ++i) {
    EXPECT_EQ(back.bins[i].box.lo_deg, model.bins[i].box.lo_deg);
    EXPECT_EQ(back.bins[i].box.hi_deg, model.bins[i].box.hi_deg);
    EXPECT_EQ(back.bins[i].extent, model.bins[i].extent);
  }
}

TEST(ModelFile, KeepsMarksToFarLessThanTheyMatter) {
  const ObjectModel model = test::make_box_model(1, 3, 3);
  const ObjectModel back = decode_model(encode_model(model), "memory");
  ASSERT_EQ(back.marks.size(), model.marks.size());
  for (std::size_t i = 0; i < back.marks.size(); ++i) {
    EXPECT_LT((back.marks[i].point - model.marks[i].point).norm(), 1e-5);
    EXPECT_LT((back.marks[i].direction - model.marks[i].direction).norm(), 0.01);
    EXPECT_LT((back.marks[i].normal - model.marks[i].normal).norm(), 0.01);
  }
}

TEST(ModelFile, AModelWithoutMarksAndCalibrationHasNone) {
  ObjectModel model = test::make_box_model(1, 3, 3);
  model.marks.clear();
  model.confidence = {};
  const ObjectModel back = decode_model(encode_model(model), "memory");
  EXPECT_TRUE(back.marks.empty());
  EXPECT_FALSE(back.confidence.calibrated);
}

TEST(ModelFile, RoundsOnlyOnce) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const double radius = 0.005 * std::exp2(static_cast<double>(seed % 10));
    const ObjectModel model = test::make_random_model(3, 20, radius, seed);
    const auto bytes = encode_model(model);
    ASSERT_EQ(encode_model(decode_model(bytes, "memory")), bytes) << "seed " << seed;
  }
  const auto bytes = encode_model(test::make_box_model(18, 30, 5));
  EXPECT_EQ(encode_model(decode_model(bytes, "memory")), bytes);
}

TEST(ModelFile, WholeModelIsSmallerThanFourMegabytes) {
  ObjectModel model = test::make_random_model(360, 100, 0.15, 1);
  // With the largest mesh that a simplifier is likely to leave: 5000 vertices, 10000 triangles.
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::uint32_t> index(0, 4999);
  model.mesh.vertices.clear();
  model.mesh.triangles.clear();
  for (int i = 0; i < 5000; ++i) model.mesh.vertices.emplace_back(Eigen::Vector3f::Random() * 0.1F);
  for (int i = 0; i < 10000; ++i)
    model.mesh.triangles.push_back({index(random), index(random), index(random)});
  const std::size_t bytes = encode_model(model).size();
  std::printf("360 bins of 100 + 100 parts: %zu bytes\n", bytes);
  EXPECT_LT(bytes, 4000000U);
}

TEST(ModelFile, LargeMeshesUseWideIndices) {
  ObjectModel model = test::make_box_model(1, 2, 1);
  const Eigen::Vector3f corner = model.mesh.vertices[0];
  for (const std::size_t count : {std::size_t{65536}, std::size_t{65537}}) {
    model.mesh.vertices.assign(count, corner);
    model.mesh.triangles = {{0, 1, static_cast<std::uint32_t>(count - 1)}};
    const auto bytes = encode_model(model);
    EXPECT_EQ(decode_model(bytes, "memory").mesh.triangles, model.mesh.triangles);
    EXPECT_EQ(encode_model(decode_model(bytes, "memory")), bytes);
  }
  model.mesh = {};
  EXPECT_TRUE(decode_model(encode_model(model), "memory").mesh.triangles.empty());
}

TEST(ModelFile, ReadsBytesAtAnyAddress) {
  const auto bytes = encode_model(test::make_box_model(1, 3, 1));
  for (std::size_t offset = 0; offset < 8; ++offset) {
    std::vector<std::byte> moved(offset);
    moved.insert(moved.end(), bytes.begin(), bytes.end());
    EXPECT_EQ(encode_model(decode_model(std::span(moved).subspan(offset), "memory")), bytes);
  }
}

TEST(ModelFile, HashFollowsTheContent) {
  ObjectModel model = test::make_box_model(1, 3, 1);
  const auto bytes = encode_model(model);
  EXPECT_EQ(model_hash(bytes), model_hash(encode_model(model)));
  model.bins[0].visual[0].variance *= 1.01F;
  EXPECT_NE(model_hash(bytes), model_hash(encode_model(model)));
  EXPECT_THROW(model_hash(std::span(bytes).first(10)), InputError);
}

TEST(ModelFile, RefusesToWriteWhatItCannotHold) {
  ObjectModel model = test::make_box_model(1, 3, 1);
  model.bins[0].visual[1].u[2] = 40;  // 40 m per radian: steps of 2 mm
  EXPECT_THROW(encode_model(model), InputError);
  model = test::make_box_model(1, 3, 1);
  model.bins[0].depth[0].px = 5;
  EXPECT_THROW(encode_model(model), InputError);
  model = test::make_box_model(1, 3, 1);
  model.bins[0].depth[0].variance = NAN;
  EXPECT_THROW(encode_model(model), InputError);
}

TEST_F(ModelFileOnDisk, WritesAndReadsBack) {
  const ObjectModel model = test::make_box_model(3, 10, 1);
  const fs::path file = folder_ / "box.sxm";
  write_model(model, file);
  write_model(model, file);  // replaces
  const ModelFileContent content = read_model_file(file);
  const auto bytes = encode_model(model);
  EXPECT_EQ(content.bytes, bytes.size());
  EXPECT_EQ(content.hash, model_hash(bytes));
  EXPECT_EQ(encode_model(content.model), bytes);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()),
            1);  // no temporary left
}

TEST_F(ModelFileOnDisk, RefusesWhatIsNoModelFile) {
  EXPECT_THROW(read_model(folder_), InputError);
  EXPECT_THROW(read_model(folder_ / "missing.sxm"), InputError);
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(read_model(pipe), InputError);
  std::ofstream(folder_ / "empty.sxm").close();
  EXPECT_THROW(read_model(folder_ / "empty.sxm"), InputError);
  std::ofstream(folder_ / "text.sxm") << "This is a text of more than twenty-four bytes.";
  EXPECT_THROW(read_model(folder_ / "text.sxm"), InputError);
  std::ofstream(folder_ / "huge.sxm").close();
  fs::resize_file(folder_ / "huge.sxm", kMaxModelFileBytes + 1);
  EXPECT_THROW(read_model(folder_ / "huge.sxm"), InputError);
}

TEST_F(ModelFileOnDisk, SaysWhereItCouldNotWrite) {
  try {
    write_model(test::make_box_model(1, 2, 1), folder_ / "no such folder" / "box.sxm");
    FAIL() << "wrote into a folder that does not exist";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("no such folder"), std::string::npos);
  }
}

}  // namespace
}  // namespace sextant
