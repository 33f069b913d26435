// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/dds_log.h"

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <gmock/gmock.h>

#include <vector>

namespace sextant {
namespace {

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
