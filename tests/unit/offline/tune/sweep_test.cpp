// SPDX-License-Identifier: Apache-2.0
#include "offline/tune/sweep.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "runtime/base/error.h"

namespace sextant {
namespace {

TEST(Sweep, IsReadFromText) {
  const Sweep sweep = parse_sweep("visual_radius_px=4,6.5");
  EXPECT_EQ("visual_radius_px", sweep.name);
  EXPECT_EQ((std::vector<std::string>{"4", "6.5"}), sweep.values);
  for (const char* bad : {"", "x", "x=", "=1", "x=1,", "x=,1", "x=1,,2"})
    EXPECT_THROW(parse_sweep(bad), UsageError) << bad;
}

TEST(Sweep, OneAtATimeStartsWithTheDefaults) {
  const auto points = points_of({{"a", {"1", "2"}}, {"b", {"x", "x"}}}, false);
  EXPECT_EQ((std::vector<TunePoint>{{}, {{"a", "1"}}, {{"a", "2"}}, {{"b", "x"}}}), points);
}

TEST(Sweep, GridIsEveryCombinationWithTheDefaultsAmongThem) {
  const auto points = points_of({{"a", {"1", "2"}}, {"b", {"x"}}}, true);
  EXPECT_EQ(6U, points.size());
  EXPECT_TRUE(points[0].empty());
  EXPECT_EQ(1, std::count(points.begin(), points.end(), TunePoint{{"a", "2"}, {"b", "x"}}));
}

TEST(Sweep, TooMuchOrTwiceIsRefused) {
  EXPECT_THROW(points_of({{"a", {"1"}}, {"a", {"2"}}}, false), UsageError);
  const std::vector<std::string> many(200, "1");
  std::vector<Sweep> sweeps;
  for (const char* name : {"p", "q", "r"}) sweeps.push_back({name, many});
  EXPECT_THROW(points_of(sweeps, true), UsageError);
}

TEST(Sweep, AppliesToLearningAndSearch) {
  const TuneParameters p = apply({}, {{"depth_parts", "50"},
                                      {"angle_tolerance_deg", "9"},
                                      {"height_tolerance_m", "0.005"},
                                      {"scoring", "thesis"},
                                      {"threshold", "12.5"}});
  EXPECT_EQ(50, p.learn.depth_parts);
  EXPECT_EQ(9, p.learn.angle_tolerance_deg);
  EXPECT_NEAR(0.15708, p.detect.tolerance.angle_rad, 1e-5) << "the search is as tolerant as the model";
  EXPECT_EQ(0.005, p.detect.tolerance.height_m);
  EXPECT_EQ("thesis", p.detect.scoring);
  EXPECT_EQ(12.5, p.detect.threshold);
  EXPECT_THROW(apply({}, {{"no_such", "1"}}), UsageError);
  EXPECT_THROW(apply({}, {{"depth_parts", "many"}}), UsageError);
  EXPECT_THROW(apply({}, {{"depth_parts", "2.5"}}), UsageError);
  EXPECT_THROW(apply({}, {{"bin_width_deg", "100"}}), UsageError);
}

}  // namespace
}  // namespace sextant
