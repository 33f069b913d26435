// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/single_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "runtime/base/error.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kGood =
    "width: 32\nheight: 24\nfx: 30\nfy: 31\ncx: 15.5\ncy: 11.5\n"
    "distortion: [0.1, -0.2, 0.001, 0.002, 0.05]\ndepth_scale_mm: 0.5\npitch_deg: 40\nroll_deg: "
    "-2\nheight_m: 0.8\n";

class SingleFrame : public testing::Test {
 protected:
  SingleFrame() {
    write_small_image(folder_.path(), 1, 2);
    write_text(camera_, kGood);
  }
  RgbdFrame load() const {
    return load_single_frame(folder_ / "rgb/000002.png", folder_ / "depth/000002.png", camera_);
  }
  std::string refusal(const std::string& yaml) {
    write_text(camera_, yaml);
    try {
      load();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  TemporaryFolder folder_;
  std::filesystem::path camera_ = folder_ / "camera.yaml";
};

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  return text.replace(text.find(what), what.size(), with);
}

TEST_F(SingleFrame, ReadsEverything) {
  const RgbdFrame frame = load();
  EXPECT_EQ(cv::Vec3b(1, 2, 7), frame.colour.at<cv::Vec3b>(3, 3));
  EXPECT_FLOAT_EQ(0.501F, frame.axial_depth_m.at<float>(3, 3));
  EXPECT_EQ(31, frame.camera.fy);
  EXPECT_EQ(0.05, frame.camera.distortion[4]);
  EXPECT_EQ(0, frame.camera.distortion[5]);
  ASSERT_TRUE(frame.table.has_value());
  EXPECT_NEAR(40 * 3.14159265358979 / 180, frame.table->pitch_rad(), 1e-12);
  EXPECT_NEAR(-2 * 3.14159265358979 / 180, frame.table->roll_rad(), 1e-12);
}

TEST_F(SingleFrame, TableAndDistortionAreOptional) {
  EXPECT_EQ("", refusal(kGood.substr(0, kGood.find("distortion")) + "depth_scale_mm: 1\n"));
  EXPECT_FALSE(load().table.has_value());
  EXPECT_FALSE(load().camera.has_distortion());
}

TEST_F(SingleFrame, RefusalsNameFileLineAndKey) {
  EXPECT_THAT(refusal(replaced(kGood, "fx:", "focal_x:")),
              AllOf(HasSubstr("camera.yaml:3"), HasSubstr("focal_x")));
  EXPECT_THAT(refusal(replaced(kGood, "pitch_deg", "pitch_degrees")), HasSubstr("did you mean pitch_deg?"));
  EXPECT_THAT(refusal(replaced(kGood, "fy: 31\n", "")), HasSubstr("\"fy\" is missing"));
  EXPECT_THAT(refusal(replaced(kGood, "fx: 30", "fx: thirty")),
              AllOf(HasSubstr("camera.yaml:3"), HasSubstr("fx must be a number")));
  EXPECT_THAT(refusal(replaced(kGood, "fx: 30", "fx: .nan")), HasSubstr("fx must be a number"));
  EXPECT_THAT(refusal(replaced(kGood, "width: 32", "width: 32.5")), HasSubstr("whole number"));
  EXPECT_THAT(refusal(replaced(kGood, "width: 32", "width: 33")), HasSubstr("says 33 x 24"));
  EXPECT_THAT(refusal(replaced(kGood, "0.05]", "0.05, 1, 2, 3, 4]")), HasSubstr("at most 8"));
  EXPECT_THAT(refusal(replaced(kGood, "height_m: 0.8\n", "")), HasSubstr("both pitch_deg and height_m"));
  EXPECT_THAT(refusal(replaced(kGood, "depth_scale_mm: 0.5", "depth_scale_mm: 0")),
              HasSubstr("depth_scale_mm"));
  EXPECT_THAT(refusal("[1, 2]"), HasSubstr("key: value"));
  EXPECT_THAT(refusal("a: [1"), HasSubstr("not valid YAML"));
  EXPECT_THAT(refusal(std::string(5000, '[')), HasSubstr("camera.yaml"));
  EXPECT_THAT(refusal(std::string(100000, '#')), HasSubstr("more than the limit"));
  EXPECT_THAT(refusal(""), HasSubstr("key: value"));
}

TEST_F(SingleFrame, RandomDamageNeverCrashes) {
  std::mt19937 random(9);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string text = kGood;
    for (std::uint32_t k = 0; k < 1 + random() % 3; ++k) {
      if (random() % 2) {
        text[random() % text.size()] = static_cast<char>(random());
      } else {
        text.insert(random() % text.size(), 1, "{}[]\",:-&*!|>%@`#?\n\t"[random() % 20]);
      }
    }
    write_text(camera_, text);
    try {
      read_camera_file(camera_);
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("camera.yaml"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace sextant
