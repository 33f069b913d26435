// SPDX-License-Identifier: Apache-2.0
// What may leave the process, and that constants on the wire are those of the code.
#include "runtime/publish/message_builder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <regex>
#include <stdexcept>

#include "tests/unit/runtime/publish/example_result.h"

namespace sextant {
namespace {

TEST(CheckPublishable, AcceptsValidResults) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    EXPECT_NO_THROW(check_publishable(random_result(seed, static_cast<int>(seed % 4))));
  }
}

TEST(CheckPublishable, RefusesWhatMustNotLeave) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](auto&& change) {
    FrameResult result = random_result(1, 2);
    change(result);
    EXPECT_THROW(check_publishable(result), std::logic_error);
  };
  refused([](FrameResult& r) { r.captured_at = {}; });
  refused([](FrameResult& r) { r.captured_at = CaptureTime(std::chrono::nanoseconds(-5)); });
  refused([](FrameResult& r) { r.captured_at = CaptureTime(std::chrono::seconds(1LL << 31)); });
  refused([&](FrameResult& r) { r.estimates[1].camera_from_object.translation().x() = nan; });
  refused([](FrameResult& r) { r.estimates[1].camera_from_object.linear() *= 1.01; });
  refused([](FrameResult& r) { r.estimates[1].camera_from_object.linear().col(0) *= -1; });
  refused([&](FrameResult& r) { r.estimates[0].covariance(3, 3) = infinity; });
  refused([](FrameResult& r) { r.estimates[0].score = 1.5; });
  refused([&](FrameResult& r) { r.estimates[0].score = nan; });
  refused([&](FrameResult& r) { r.estimates[0].gap = nan; });
  refused([&](FrameResult& r) { r.estimates[0].bbox[2] = nan; });
  refused([&](FrameResult& r) { r.objects[0].upper_bound = nan; });
  refused([](FrameResult& r) { r.objects[0].coverage = 1.01; });
  refused([&](FrameResult& r) { r.seconds.total = nan; });
}

TEST(ObjectPose, IsTheFirstOfTheBestScores) {
  FrameResult result = random_result(5, 4);
  const double scores[] = {0.2, 0.8, 0.8, 0.1};
  for (int i = 0; i < 4; ++i) result.estimates[static_cast<std::size_t>(i)].score = scores[i];
  const auto best = build_object_pose(result);
  ASSERT_TRUE(best);
  EXPECT_EQ(best->pose.position.x, result.estimates[1].camera_from_object.translation().x());
  EXPECT_FALSE(build_object_pose(random_result(5, 0)));
}

TEST(Constants, OfTheMsgFileAreThoseOfTheCode) {
  std::ifstream file(SEXTANT_SOURCE_DIR "/idl/msg/sextant_msgs/msg/PoseEstimate.msg");
  const std::regex constant(R"(uint8 STATUS_([A-Z]+)=([0-9]+).*)");
  int seen = 0;
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, constant)) continue;
    std::string name = match[1];
    for (char& c : name) c = static_cast<char>(c - 'A' + 'a');
    EXPECT_EQ(name, to_string(static_cast<SearchStatus>(std::stoi(match[2]))));
    ++seen;
  }
  EXPECT_EQ(seen, 3);
}

}  // namespace
}  // namespace sextant
