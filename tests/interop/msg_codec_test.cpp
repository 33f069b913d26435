// SPDX-License-Identifier: Apache-2.0
// The referee itself: bytes that are written down here by hand.
#include "tests/interop/msg_codec.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

using Json = nlohmann::json;

TEST(MsgCodec, WritesTheBytesThatCdrPrescribes) {
  MsgCodec codec(SEXTANT_SOURCE_DIR "/idl/msg");
  // Encapsulation (CDR, little endian), sec, nanosec, length 4, "cam\0".
  const std::vector<std::uint8_t> header = {0, 1, 0, 0, 7, 0, 0, 0, 9, 0, 0, 0, 4, 0, 0, 0, 'c', 'a', 'm', 0};
  const Json value = {{"stamp", {{"sec", 7}, {"nanosec", 9}}}, {"frame_id", "cam"}};
  EXPECT_EQ(codec.encode("std_msgs/Header", value), header);
  EXPECT_EQ(codec.decode("std_msgs/Header", header), value);
  // Doubles begin at multiples of 8 after the encapsulation.
  const auto pose =
      codec.encode("geometry_msgs/PoseStamped", {{"header", value}, {"pose", {{"position", {{"x", 1.0}}}}}});
  EXPECT_EQ(pose.size(), 4U + 16 + 7 * 8);
  EXPECT_EQ(pose[4 + 16 + 7], 0x3f);
}

TEST(MsgCodec, RefusesTooFewAndTooManyBytes) {
  MsgCodec codec(SEXTANT_SOURCE_DIR "/idl/msg");
  auto bytes = codec.encode("sextant_msgs/Command", {{"request_id", "a"}, {"region", {1, 2, 3, 4}}});
  EXPECT_EQ(codec.decode("sextant_msgs/Command", bytes)["region"], Json({1, 2, 3, 4}));
  bytes.resize(bytes.size() - 4);
  EXPECT_ANY_THROW(codec.decode("sextant_msgs/Command", bytes));
  bytes.resize(bytes.size() + 12);
  EXPECT_ANY_THROW(codec.decode("sextant_msgs/Command", bytes));
  EXPECT_ANY_THROW(codec.encode("sextant_msgs/Command", {{"no_such_field", 1}}));
}

}  // namespace
}  // namespace sextant
