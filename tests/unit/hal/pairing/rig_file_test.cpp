// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "runtime/base/error.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

constexpr char kGood[] =
    R"(colour: {width: 640, height: 480, fx: 525, fy: 524, cx: 319.5, cy: 239.5, distortion: [0.1, -0.2]}
depth: {width: 320, height: 240, fx: 290, fy: 290, cx: 160, cy: 120, metres_per_unit: 0.0002, farthest_m: 4}
colour_from_depth:
  translation_m: [-0.025, 0, 0.001]
  rotation: [0.99995, -0.01, 0,  0.01, 0.99995, 0,  0, 0, 1]
tolerance_ms: 8
)";

class RigFileTest : public ::testing::Test {
 protected:
  RigFile read(const std::string& text) const {
    std::ofstream(folder_.path() / "rig.yaml") << text;
    return read_rig_file(folder_.path() / "rig.yaml");
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  static std::string good_but(const std::string& from, const std::string& to) {
    std::string text = kGood;
    return text.replace(text.find(from), from.size(), to);
  }
  TemporaryFolder folder_;
};

TEST_F(RigFileTest, ReadsBothCamerasAndHowTheyBelongTogether) {
  const RigFile rig = read(kGood);
  EXPECT_EQ(rig.calibration.colour.fy, 524);
  EXPECT_EQ(rig.calibration.colour.distortion[1], -0.2);
  EXPECT_EQ(rig.calibration.depth.width, 320);
  EXPECT_EQ(rig.calibration.colour_from_depth.translation().x(), -0.025);
  EXPECT_NEAR(rig.calibration.colour_from_depth.linear().determinant(), 1, 1e-12);
  EXPECT_EQ(rig.depth_scale.metres_per_unit, 0.0002);
  EXPECT_EQ(rig.depth_scale.farthest_m, 4);
  EXPECT_EQ(rig.synchroniser.tolerance, std::chrono::milliseconds(8));
}

TEST_F(RigFileTest, RegisteredDepthNeedsNoSecondCamera) {
  const RigFile rig = read(
      "colour: {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: 239.5}\n"
      "depth: {registered: true, encoding: kinect}\nshared_sequence: true\n");
  EXPECT_TRUE(rig.calibration.depth_is_registered);
  EXPECT_EQ(rig.depth_scale.encoding, DepthScale::Encoding::kKinectDisparity);
  EXPECT_TRUE(rig.synchroniser.shared_sequence);
  EXPECT_EQ(rig.synchroniser.tolerance, std::chrono::milliseconds(17));
}

TEST_F(RigFileTest, SaysLineAndKeyOfWhatIsWrong) {
  EXPECT_THAT(refusal(good_but("fx: 525", "fx: none")), testing::HasSubstr("rig.yaml:1: colour.fx must be"));
  EXPECT_THAT(refusal(good_but("fx: 525, ", "")), testing::HasSubstr("colour.fx is missing"));
  EXPECT_THAT(refusal(good_but("metres_per_unit", "meters_per_unit")),
              testing::HasSubstr("rig.yaml:2: unknown key \"meters_per_unit\""));
  EXPECT_THAT(refusal(good_but("[-0.025, 0, 0.001]", "[-25, 0, 1]")), testing::HasSubstr("rig.yaml:4"));
  EXPECT_THAT(refusal(good_but("0.99995, -0.01, 0,  0.01", "2, -0.01, 0,  0.01")),
              testing::HasSubstr("no rotation matrix"));
  EXPECT_THAT(refusal(good_but("depth: {", "depth: {registered: true, ")),
              testing::HasSubstr("registered depth has no colour_from_depth"));
  EXPECT_THAT(refusal(good_but("width: 640", "width: 640.5")), testing::HasSubstr("whole number"));
  EXPECT_THAT(refusal("colour: ["), testing::HasSubstr("not valid YAML"));
  EXPECT_THAT(refusal("- 1"), testing::HasSubstr("must be a list of"));
  EXPECT_THROW(read_rig_file(folder_.path() / "none.yaml"), InputError);
}

}  // namespace
}  // namespace sextant
