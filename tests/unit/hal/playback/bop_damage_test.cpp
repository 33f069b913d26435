// SPDX-License-Identifier: Apache-2.0
// Damaged data sets: every refusal names the file, the image and the key; random damage never crashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Opens and loads everything; the message of the error, or "" where all is well.
std::string outcome(const std::filesystem::path& folder) {
  try {
    for (const BopImage& image : open_bop_dataset(folder, "test").images) load_frame(image);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

struct Damage {
  const char* file;
  const char* content;
  const char* place;   ///< of the message
  const char* reason;  ///< of the message
};

class DamagedBop : public testing::TestWithParam<Damage> {};

TEST_P(DamagedBop, IsRefusedByFileImageAndKey) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  ASSERT_EQ("", outcome(folder.path()));
  const std::filesystem::path file = folder.path() / "test/000010" / GetParam().file;
  write_text(file, GetParam().content);
  EXPECT_THAT(outcome(folder.path()),
              AllOf(HasSubstr(file.string()), HasSubstr(GetParam().place), HasSubstr(GetParam().reason)));
}

constexpr const char* kCamera = "scene_camera.json";
INSTANTIATE_TEST_SUITE_P(
    Each, DamagedBop,
    testing::Values(
        Damage{kCamera, "", "", "not valid JSON"}, Damage{kCamera, "{\"2\": ", "", "not valid JSON"},
        Damage{kCamera, "[]", "", "must be an object"},
        Damage{kCamera, "{\"two\": {}}", "two", "whole number"},
        Damage{kCamera, "{\"02\": {}}", "02", "whole number"},
        Damage{kCamera, "{\"99999999999\": {}}", "99999999999", "whole number"},
        Damage{kCamera, "{\"2\": 7}", "image 2", "must be an object"},
        Damage{kCamera, "{\"2\": {\"depth_scale\": 1}}", "image 2", "\"cam_K\" is missing"},
        Damage{kCamera, "{\"2\": {\"cam_K\": [1, 2], \"depth_scale\": 1}}", "image 2: cam_K", "9 numbers"},
        Damage{kCamera, R"({"2": {"cam_K": [30,0,15,0,"x",11,0,0,1], "depth_scale": 1}})",
               "image 2: cam_K[4]", "a number"},
        Damage{kCamera, R"({"2": {"cam_K": [30,0,15,0,1e400,11,0,0,1], "depth_scale": 1}})", "",
               "not valid JSON"},
        Damage{kCamera, R"({"2": {"cam_K": [30,1,15,0,30,11,0,0,1], "depth_scale": 1}})", "image 2: cam_K",
               "must be [fx"},
        Damage{kCamera, R"({"2": {"cam_K": [-30,0,15,0,30,11,0,0,1], "depth_scale": 1}})", "image 2: cam_K",
               "not positive"},
        Damage{kCamera, R"({"2": {"cam_K": [3e8,0,15,0,30,11,0,0,1], "depth_scale": 1}})", "image 2",
               "focal lengths"},
        Damage{kCamera, R"({"2": {"cam_K": [30,0,15,0,30,11,0,0,1]}})", "image 2",
               "\"depth_scale\" is missing"},
        Damage{kCamera, R"({"2": {"cam_K": [30,0,15,0,30,11,0,0,1], "depth_scale": 0}})",
               "image 2: depth_scale", "between"},
        Damage{"scene_table.json", R"({"2": {"pitch_rad": 0.1, "roll_rad": 0}})", "image 2",
               "\"height_m\" is missing"},
        Damage{"scene_table.json", R"({"2": {"pitch_rad": 45, "roll_rad": 0, "height_m": 1}})",
               "image 2: pitch_rad", "between"},
        Damage{"scene_gt.json", R"({"2": {}})", "image 2", "must be an array"},
        Damage{"scene_gt.json", R"({"2": [{"cam_t_m2c": [0,0,1], "obj_id": 1}]})", "image 2[0]",
               "\"cam_R_m2c\" is missing"},
        Damage{"scene_gt.json",
               R"({"2": [{"cam_R_m2c": [1,0,0,0,1,0,0,0,-1], "cam_t_m2c": [0,0,1], "obj_id": 1}]})",
               "image 2[0]: cam_R_m2c", "not a rotation"},
        Damage{"scene_gt.json",
               R"({"2": [{"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,1e8], "obj_id": 1}]})",
               "image 2[0]: cam_t_m2c", "kilometre"},
        Damage{"scene_gt.json",
               R"({"2": [{"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,1], "obj_id": 1.5}]})",
               "image 2[0]: obj_id", "whole number"},
        Damage{"scene_gt_info.json", R"({"2": []})", "image 2", "0 entries, but scene_gt.json has 1"},
        Damage{"scene_gt_info.json", R"({"2": [{"visib_fract": 3}]})", "image 2[0]: visib_fract", "between"},
        Damage{"rgb/000011.png", "no picture", "", "neither a PNG nor a JPEG"},
        Damage{"depth/000002.png", "", "", "neither a PNG nor a JPEG"}));

TEST(DamagedBopFolder, MissingPartsAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(outcome(folder / "nowhere"), HasSubstr("nowhere/test"));
  std::filesystem::create_directories(folder / "test");
  EXPECT_THAT(outcome(folder.path()), HasSubstr("holds no scene"));
  write_small_bop(folder.path());
  std::filesystem::create_directories(folder / "test/notes");  // not a scene: ignored
  EXPECT_EQ("", outcome(folder.path()));
  std::filesystem::create_directories(folder / "test/10");
  EXPECT_THAT(outcome(folder.path()), HasSubstr("scene 10 is there twice"));
  std::filesystem::remove_all(folder / "test/10");
  std::filesystem::remove(folder / "test/000010/depth/000011.png");
  EXPECT_THAT(outcome(folder.path()),
              AllOf(HasSubstr("000010/depth/000011.png"), HasSubstr("does not exist")));
  std::filesystem::remove(folder / "test/000001/scene_camera.json");
  EXPECT_THAT(outcome(folder.path()),
              AllOf(HasSubstr("000001/scene_camera.json"), HasSubstr("does not exist")));
  write_text(folder / "test/000001/scene_camera.json", std::string(1000, '[') + std::string(1000, ']'));
  EXPECT_THAT(outcome(folder.path()), HasSubstr("nested deeper"));
}

TEST(DamagedBopFolder, SizesThatDifferAreNamed) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  write_png(folder / "test/000001/depth/000002.png", cv::Mat(24, 31, CV_16UC1, cv::Scalar(1)));
  EXPECT_THAT(outcome(folder.path()), AllOf(HasSubstr("31 x 24"), HasSubstr("32 x 24")));
}

TEST(DamagedBopFolder, RandomDamageIsRefusedOrHarmless) {
  const TemporaryFolder folder;
  write_small_bop(folder.path());
  std::mt19937 random(5);
  int refused = 0;
  for (const char* name : {"scene_camera.json", "scene_gt.json", "scene_gt_info.json", "scene_table.json"}) {
    const std::filesystem::path file = folder.path() / "test/000001" / name;
    std::stringstream original;
    original << std::ifstream(file).rdbuf();
    for (int i = 0; i < 400; ++i) {
      std::string text = original.str();
      switch (random() % 3) {
        case 0:
          text.resize(random() % text.size());
          break;
        case 1:
          text[random() % text.size()] = static_cast<char>(random());
          break;
        default:
          text.insert(random() % text.size(), 1, "{}[]\",:-e9\\"[random() % 11]);
      }
      write_text(file, text);
      try {
        open_bop_dataset(folder.path(), "test");
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("scene_")) << text;
        ++refused;
      }
    }
    write_text(file, original.str());
  }
  EXPECT_GT(refused, 800);
}

}  // namespace
}  // namespace sextant
