// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/inspect_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hal/image/image_file.h"
#include "offline/cli/model_summary.h"
#include "runtime/base/error.h"
#include "synthetic_model.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Inspect : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sextant-inspect-test-" + std::to_string(::getpid()) + "-" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    file_ = folder_ / "box.sxm";
    write_model(test::make_box_model(15, 40, 1), file_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// What the command prints; its errors pass through.
  std::string run(const std::vector<std::string>& arguments) {
    CLI::App app;
    add_inspect_command(app, exit_code_);
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    reversed.emplace_back("inspect");
    testing::internal::CaptureStdout();
    try {
      app.parse(reversed);
    } catch (...) {
      testing::internal::GetCapturedStdout();
      throw;
    }
    return testing::internal::GetCapturedStdout();
  }

  fs::path folder_;
  fs::path file_;
  int exit_code_ = -1;
};

TEST_F(Inspect, PrintsContentsAndProvenance) {
  const std::string text = run({file_.string()});
  EXPECT_EQ(exit_code_, 0);
  for (const char* said :
       {"box (object id 7)", "version 3", "sextant 0.1.0, seed 1", "box.ply (XXH3 0123456789abcdef)",
        "{images: 100, parts: 100}", "bounding radius 135.4 mm, centre 105.0 mm above",
        "8 vertices, 12 triangles", "30: rx -10..10, ry -60..-20, rz 0..300 deg", "(24 of 30 bins"}) {
    EXPECT_THAT(text, HasSubstr(said));
  }
  EXPECT_THAT(run({file_.string(), "--bins", "30"}), testing::Not(HasSubstr("of 30 bins")));
}

TEST_F(Inspect, JsonHoldsEveryBin) {
  const std::string text = run({file_.string(), "--json"});
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  const auto json = nlohmann::json::parse(text);
  const ObjectModel model = read_model(file_);
  EXPECT_EQ(json["name"], "box");
  EXPECT_EQ(json["bytes"], fs::file_size(file_));
  EXPECT_EQ(json["checksum"].get<std::string>().size(), 16U);
  EXPECT_EQ(json["object_from_mesh"][2][3], model.object_from_mesh.translation().z());
  EXPECT_EQ(json["provenance"]["mesh_hash"], "0123456789abcdef");
  ASSERT_EQ(json["bins"].size(), model.bins.size());
  for (std::size_t i = 0; i < model.bins.size(); ++i) {
    EXPECT_EQ(json["bins"][i]["rz_deg"][0], model.bins[i].box.lo_deg[2]);
    EXPECT_EQ(json["bins"][i]["visual"]["parts"], 40);
    int parts = 0;
    for (const auto& kind : json["bins"][i]["visual"]["parts_per_kind"]) parts += kind.get<int>();
    EXPECT_EQ(parts, 40);
    EXPECT_GT(json["bins"][i]["depth"]["variance_m2"]["p50"], 0);
  }
}

TEST_F(Inspect, PictureShowsTheBins) {
  const fs::path picture = folder_ / "box.png";
  EXPECT_THAT(run({file_.string(), "--picture", picture.string(), "--bins", "6"}), HasSubstr("box.png"));
  const cv::Mat image = read_colour_image(picture);
  EXPECT_GT(image.cols, 400);
  const cv::Mat more = [&] {
    run({file_.string(), "--picture", picture.string()});
    return read_colour_image(picture);
  }();
  EXPECT_GT(more.total(), 2 * image.total());
}

TEST_F(Inspect, RefusesBadModelsAndBadUse) {
  std::ofstream(folder_ / "bad.sxm") << "not a model, but long enough for a header";
  EXPECT_THROW(run({(folder_ / "bad.sxm").string()}), InputError);
  EXPECT_THROW(run({(folder_ / "missing.sxm").string()}), InputError);
  EXPECT_THROW(run({file_.string(), "--picture", (folder_ / "no" / "a.png").string()}), InputError);
  EXPECT_THROW(run({file_.string(), "--bins", "0"}), CLI::ParseError);
  EXPECT_THROW(run({}), CLI::ParseError);
}

TEST(Quantile, Interpolates) {
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_EQ(quantile({3}, 0.9), 3);
  EXPECT_DOUBLE_EQ(quantile({0, 1, 2, 3, 10}, 0.5), 2);
  EXPECT_DOUBLE_EQ(quantile({0, 1, 2, 3, 10}, 0.95), 8.6);
  EXPECT_EQ(quantile({1, 2}, 1), 2);
}

}  // namespace
}  // namespace sextant
