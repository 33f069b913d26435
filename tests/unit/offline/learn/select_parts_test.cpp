// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/select_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sextant {
namespace {

std::vector<PartCandidate> random_candidates(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<PartCandidate> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back({unit(random), {500 * unit(random), 500 * unit(random)}, static_cast<int>(i % 3), i});
  }
  return out;
}

TEST(SelectParts, TakesTheWantedNumberAsFarApartAsItCan) {
  const auto candidates = random_candidates(3000);
  const auto chosen = select_parts(candidates, 60, 0.8).parts;
  ASSERT_EQ(chosen.size(), 60U);
  double nearest = 1e9;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    EXPECT_LE(chosen[i].variance, 0.8);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_LE(chosen[k].variance, chosen[i].variance);
      if (chosen[i].kind == chosen[k].kind)
        nearest = std::min(nearest, (chosen[i].position - chosen[k].position).norm());
    }
  }
  // The largest whole spacing that works is below the smallest distance found, and one more does not work.
  auto sorted = candidates;
  std::erase_if(sorted, [](const PartCandidate& c) { return c.variance > 0.8; });
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.variance < b.variance; });
  int largest = 0;
  for (int d = 0; d <= kLargestSpacing; ++d) {
    if (select_greedily(sorted, d, 60).size() == 60) largest = d;
  }
  EXPECT_GT(nearest, largest - 3);
  EXPECT_GT(largest, 20);
}

TEST(SelectParts, ManyPixelsWithOneFeatureGiveOnePart) {
  std::vector<PartCandidate> same(50, PartCandidate{0.1, {7, 7}, 2, 0});
  EXPECT_EQ(select_parts(same, 10, 1).parts.size(), 1U);
  for (std::size_t i = 0; i < same.size(); ++i) same[i].kind = static_cast<int>(i % 4);
  EXPECT_EQ(select_parts(same, 10, 1).parts.size(), 4U);  // one of each kind
}

TEST(SelectParts, TakesAllWhereThereAreFewAndNoneAboveTheLimit) {
  EXPECT_EQ(select_parts(random_candidates(5), 60, 1).parts.size(), 5U);
  EXPECT_TRUE(select_parts(random_candidates(5), 60, -1).parts.empty());
  EXPECT_TRUE(select_parts({}, 60, 1).parts.empty());
}

}  // namespace
}  // namespace sextant
