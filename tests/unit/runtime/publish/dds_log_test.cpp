// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/dds_log.h"

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <gmock/gmock.h>

#include <vector>

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

TEST(DdsLog, LimitsAFloodAndGivesTheSinkBack) {
  std::vector<std::string> lines;
  {
    const DdsLog log([&](const std::string& line) { lines.push_back(line); });
    for (int i = 0; i < 1000; ++i) dds_log(DDS_LC_WARNING, __FILE__, __LINE__, "test", "flood %d\n", i);
    ASSERT_THAT(lines, testing::SizeIs(testing::AllOf(testing::Ge(10U), testing::Lt(1000U))));
    EXPECT_THAT(lines[0], testing::HasSubstr("flood 0"));
    EXPECT_EQ(lines[0].find('\n'), std::string::npos);
  }
  const std::size_t before = lines.size();
  dds_log(DDS_LC_WARNING, __FILE__, __LINE__, "test", "after the end (expected on stderr)\n");
  EXPECT_EQ(lines.size(), before);
}

}  // namespace
}  // namespace sextant
