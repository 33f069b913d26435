// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/tf_buffer.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_pose.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;

CaptureTime at(int ms) { return CaptureTime(std::chrono::hours(1000) + milliseconds(ms)); }

RigidTransform moved(double x, double yaw = 0) {
  RigidTransform t = RigidTransform::Identity();
  t.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  t.translation().x() = x;
  return t;
}

TEST(TfBuffer, WalksTheTreeUpAndDown) {
  std::mt19937_64 random(3);
  const RigidTransform world_base = random_pose(random);
  const RigidTransform base_arm = random_pose(random);
  const RigidTransform base_camera = random_pose(random);
  TfBuffer buffer;
  EXPECT_TRUE(buffer.add({"world", "base", at(0), world_base}, true));
  EXPECT_TRUE(buffer.add({"base", "arm", at(0), base_arm}, true));
  EXPECT_TRUE(buffer.add({"base", "camera", at(0), base_camera}, true));
  const auto camera = buffer.lookup("world", "camera", at(9), milliseconds(0));
  ASSERT_TRUE(camera) << camera.error();
  EXPECT_TRUE(camera->isApprox(world_base * base_camera, 1e-12));
  const auto across = buffer.lookup("arm", "camera", at(9), milliseconds(0));
  ASSERT_TRUE(across) << across.error();
  EXPECT_TRUE(across->isApprox(base_arm.inverse() * base_camera, 1e-12));
  EXPECT_TRUE(
      buffer.lookup("camera", "camera", at(9), milliseconds(0))->isApprox(RigidTransform::Identity()));
}

TEST(TfBuffer, InterpolatesAndLimitsTheAge) {
  TfBuffer buffer;
  buffer.add({"world", "camera", at(0), moved(1, 0)}, false);
  buffer.add({"world", "camera", at(100), moved(2, 0.4)}, false);
  const auto between = buffer.lookup("world", "camera", at(25), milliseconds(0));
  ASSERT_TRUE(between);
  EXPECT_TRUE(between->isApprox(moved(1.25, 0.1), 1e-9));
  EXPECT_TRUE(buffer.lookup("world", "camera", at(250), milliseconds(200)));
  const auto old = buffer.lookup("world", "camera", at(350), milliseconds(200));
  ASSERT_FALSE(old);
  EXPECT_EQ(old.error(), "the transform of camera is 0.2 s old");
  EXPECT_FALSE(buffer.lookup("world", "camera", at(-10), milliseconds(200)));
}

TEST(TfBuffer, OutOfOrderAndResetClocks) {
  TfBuffer buffer;
  buffer.add({"world", "camera", at(100), moved(2)}, false);
  buffer.add({"world", "camera", at(0), moved(1)}, false);
  EXPECT_TRUE(buffer.lookup("world", "camera", at(50), milliseconds(0))->isApprox(moved(1.5), 1e-9));
  buffer.add({"world", "camera", at(-3'600'000), moved(7)}, false);
  EXPECT_TRUE(buffer.lookup("world", "camera", at(-3'600'000), milliseconds(0))->isApprox(moved(7)));
  EXPECT_FALSE(buffer.lookup("world", "camera", at(100), milliseconds(200)));
}

TEST(TfBuffer, SaysWhatIsMissing) {
  TfBuffer buffer;
  buffer.add({"a", "b", at(0), moved(1)}, true);
  const auto none = buffer.lookup("world", "b", at(0), milliseconds(0));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error(), "no transform connects b and world");
}

TEST(TfBuffer, RefusesNonsenseAndStaysBounded) {
  TfBuffer buffer;
  EXPECT_FALSE(buffer.add({"a", "a", at(0), moved(1)}, true));
  EXPECT_FALSE(buffer.add({"", "a", at(0), moved(1)}, true));
  RigidTransform bad = moved(1);
  bad.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(buffer.add({"a", "b", at(0), bad}, true));
  bad = moved(1);
  bad.linear() *= 2;
  EXPECT_FALSE(buffer.add({"a", "b", at(0), bad}, true));
  // A loop of parents must not hang.
  buffer.add({"a", "b", at(0), moved(1)}, true);
  buffer.add({"b", "a", at(0), moved(1)}, true);
  EXPECT_FALSE(buffer.lookup("world", "a", at(0), milliseconds(0)));
  int taken = 0;
  for (int i = 0; i < 2000; ++i)
    taken += buffer.add({"x", "f" + std::to_string(i), at(0), moved(1)}, true) ? 1 : 0;
  EXPECT_EQ(taken, 998);
}

}  // namespace
}  // namespace sextant
