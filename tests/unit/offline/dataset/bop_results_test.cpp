// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/bop_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "runtime/base/error.h"
#include "tests/support/random_pose.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(BopResults, AreWrittenAsTheChallengeWantsThem) {
  BopResult result;
  result.scene_id = 2;
  result.image_id = 35;
  result.object_id = 7;
  result.score = 0.5;
  result.camera_from_mesh.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  result.camera_from_mesh.translation() = Eigen::Vector3d(0.25, -0.125, 1);
  result.seconds = 0.75;
  EXPECT_EQ("2,35,7,0.5,0 -1 0 1 0 0 0 0 1,250 -125 1000,0.75", format_bop_result(result));
}

TEST(BopResults, RoundTrip) {
  const TemporaryFolder folder;
  std::mt19937_64 random(1);
  std::vector<BopResult> results;
  for (int i = 0; i < 200; ++i) {
    results.push_back({i / 10, i, i % 7, std::ldexp(1.0, -i), random_pose(random), 0.1 * i});
  }
  write_bop_results(folder / "r.csv", results);
  const std::vector<BopResult> read = read_bop_results(folder / "r.csv");
  ASSERT_EQ(results.size(), read.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].scene_id, read[i].scene_id);
    EXPECT_EQ(results[i].image_id, read[i].image_id);
    EXPECT_EQ(results[i].object_id, read[i].object_id);
    EXPECT_EQ(results[i].score, read[i].score);
    EXPECT_EQ(results[i].seconds, read[i].seconds);
    EXPECT_TRUE(results[i].camera_from_mesh.isApprox(read[i].camera_from_mesh, 1e-12));
  }
}

TEST(BopResults, OneRowPerEstimateWithTheTimeOfTheImage) {
  FrameResult frame;
  frame.scene_id = 3;
  frame.image_id = 4;
  frame.seconds.total = 1.5;
  frame.estimates.resize(2);
  frame.estimates[0].object_id = 9;
  frame.estimates[1].score = 0.25;
  const std::vector<BopResult> rows = bop_results_of(frame);
  ASSERT_EQ(2U, rows.size());
  EXPECT_EQ(9, rows[0].object_id);
  EXPECT_EQ(3, rows[1].scene_id);
  EXPECT_EQ(4, rows[1].image_id);
  EXPECT_EQ(0.25, rows[1].score);
  EXPECT_EQ(1.5, rows[0].seconds);
  EXPECT_EQ(1.5, rows[1].seconds);
}

TEST(BopResults, HeaderBlankLinesAndWindowsLineEndsAreAccepted) {
  const TemporaryFolder folder;
  const std::string row = "1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2 3,-1";
  write_text(folder / "a.csv", row + "\n");
  EXPECT_EQ(1U, read_bop_results(folder / "a.csv").size());
  write_text(folder / "b.csv", std::string(kBopResultsHeader) + "\r\n" + row + "\r\n\r\n" + row);
  EXPECT_EQ(2U, read_bop_results(folder / "b.csv").size());
  write_text(folder / "c.csv", "");
  EXPECT_TRUE(read_bop_results(folder / "c.csv").empty());
}

TEST(BopResults, RefusalsNameFileAndLine) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& row) -> std::string {
    write_text(folder / "r.csv", std::string(kBopResultsHeader) + "\n" + row + "\n");
    try {
      read_bop_results(folder / "r.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ("", refusal("1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2 3,-1"));
  EXPECT_THAT(refusal("1,2,3"), AllOf(HasSubstr("r.csv:2"), HasSubstr("7 fields")));
  EXPECT_THAT(refusal("1,2,x,0.5,1 0 0 0 1 0 0 0 1,1 2 3,-1"), HasSubstr("obj_id must be a whole number"));
  EXPECT_THAT(refusal("-1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2 3,-1"), HasSubstr("scene_id"));
  EXPECT_THAT(refusal("1,2,3,nan,1 0 0 0 1 0 0 0 1,1 2 3,-1"), HasSubstr("score must be a number"));
  EXPECT_THAT(refusal("1,2,3,0.5,1 0 0 0 1 0 0 0,1 2 3,-1"), HasSubstr("R must be 9 numbers"));
  EXPECT_THAT(refusal("1,2,3,0.5,1 0 0 0 1 0 0 0 2,1 2 3,-1"), HasSubstr("R is not a rotation"));
  EXPECT_THAT(refusal("1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2,-1"), HasSubstr("t must be 3 numbers"));
  EXPECT_THAT(refusal("1,2,3,0.5,1 0 0 0 1 0 0 0 1,1 2 3,"), HasSubstr("time must be a number"));
}

TEST(BopResults, RandomDamageNeverCrashes) {
  const TemporaryFolder folder;
  std::mt19937_64 random(2);
  write_bop_results(folder / "good.csv",
                    {{1, 2, 3, 0.5, random_pose(random), 1}, {1, 2, 4, 0.25, random_pose(random), 1}});
  std::stringstream original;
  original << std::ifstream(folder / "good.csv").rdbuf();
  int refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string text = original.str();
    text[random() % text.size()] = static_cast<char>(random());
    if (i % 3 == 0) text.resize(random() % text.size());
    write_text(folder / "bad.csv", text);
    try {
      read_bop_results(folder / "bad.csv");
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace sextant
