// SPDX-License-Identifier: Apache-2.0
// The plain tables agree with the ones in use, and notice where those belong to another frame.
#include "offline/proof/plain_tables.h"

#include <gtest/gtest.h>

#include "random_problem.h"

namespace sextant {
namespace {

TEST(PlainTables, AreTheTablesInUse) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const RandomProblem p(seed);
    EXPECT_EQ(wrong_table(p.tables(), p.frame(), p.edges()), "");
  }
}

TEST(PlainTables, OnePixelIsEnoughToNotice) {
  const RandomProblem p(5);
  SearchFrame frame = p.frame();
  frame.ray_depth_m = frame.ray_depth_m.clone();
  frame.ray_depth_m.at<float>(20, 30) += 0.001F;
  EXPECT_NE(wrong_table(p.tables(), frame, p.edges()), "");
  cv::Mat edges = p.edges().clone();
  edges.at<std::uint8_t>(20, 30) ^= 4;
  EXPECT_NE(wrong_table(p.tables(), p.frame(), edges), "");
}

}  // namespace
}  // namespace sextant
