// SPDX-License-Identifier: Apache-2.0
#include "runtime/base/rate_limiter.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

TEST(RateLimiter, PassesABurstPerPeriodAndCountsTheRest) {
  RateLimiter limiter(3, milliseconds(1000));
  const steady_clock::time_point start{};
  std::uint64_t held_back = 77;
  int passed = 0;
  for (int i = 0; i < 100; ++i) passed += limiter.pass(start + milliseconds(i), held_back) ? 1 : 0;
  EXPECT_EQ(passed, 3);
  EXPECT_EQ(held_back, 0U);
  EXPECT_TRUE(limiter.pass(start + milliseconds(1000), held_back));
  EXPECT_EQ(held_back, 97U);
  EXPECT_TRUE(limiter.pass(start + milliseconds(1001), held_back));
  EXPECT_EQ(held_back, 0U);
}

}  // namespace
}  // namespace sextant
