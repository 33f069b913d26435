// SPDX-License-Identifier: Apache-2.0
// TUM RGB-D folders, good and damaged.
#include "hal/playback/tum_dataset.h"

#include <gtest/gtest.h>

#include "hal/image/image_file.h"
#include "hal/playback/frame_reel.h"
#include "runtime/base/error.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

constexpr char kCamera[] = "width: 32\nheight: 24\nfx: 30\nfy: 31\ncx: 15.5\ncy: 11.5\ndepth_scale_mm: 0.2\n";

class TumDatasetTest : public testing::Test {
 protected:
  TumDatasetTest() {
    write_text(folder_ / "camera.yaml", kCamera);
    // The third colour image has no depth near it; the second depth image is nearer to 100.030's neighbour.
    write_text(
        folder_ / "rgb.txt",
        "# color images\n# timestamp filename\n100.000 rgb/a.png\n100.033 rgb/b.png\n100.300 rgb/c.png\n");
    write_text(folder_ / "depth.txt", "# depth maps\n100.004 depth/a.png\n100.030 depth/b.png\r\n");
    std::filesystem::create_directories(folder_ / "rgb");
    std::filesystem::create_directories(folder_ / "depth");
    for (const char* name : {"a.png", "b.png", "c.png"}) {
      write_png(folder_ / "rgb" / name, cv::Mat(24, 32, CV_8UC3, cv::Scalar(name[0], 2, 3)));
      write_png(folder_ / "depth" / name, cv::Mat(24, 32, CV_16UC1, cv::Scalar(5000)));
    }
  }
  std::filesystem::path path() const { return folder_.path(); }
  /// The error that opening makes.
  std::string error() const {
    try {
      open_tum_dataset(path());
    } catch (const InputError& e) {
      return e.what();
    }
    return "none";
  }
  struct Folder : TemporaryFolder {
    std::filesystem::path operator/(const char* name) const { return path() / name; }
  } folder_;
};

TEST_F(TumDatasetTest, PairsByTimeAndReadsMetres) {
  ASSERT_TRUE(is_tum_folder(path()));
  const auto reel = open_reel({.dataset = path()});
  ASSERT_EQ(reel->size(), 2U);
  const RgbdFrame frame = reel->load(1);
  EXPECT_EQ(frame.colour.at<cv::Vec3b>(3, 3), cv::Vec3b('b', 2, 3));
  EXPECT_FLOAT_EQ(frame.axial_depth_m.at<float>(3, 3), 1.0F);
  EXPECT_EQ(frame.captured_at.time_since_epoch(), std::chrono::milliseconds(100033));
  EXPECT_EQ(frame.camera.fy, 31);
  ASSERT_EQ(reel->remarks().size(), 1U);
  EXPECT_EQ(reel->remarks()[0], "1 of 3 colour images have no depth image within 20 ms");
}

TEST_F(TumDatasetTest, KnowsTheBenchmarksCameras) {
  const std::filesystem::path named = path() / "rgbd_dataset_freiburg1_desk";
  std::filesystem::create_directories(named);
  write_text(named / "rgb.txt", "1.0 a.png\n");
  write_text(named / "depth.txt", "1.0 b.png\n");
  const TumDataset dataset = open_tum_dataset(named);
  EXPECT_EQ(dataset.camera.camera.fx, 517.3);
  EXPECT_EQ(dataset.camera.depth_scale_mm, 0.2);
  EXPECT_TRUE(dataset.camera.camera.has_distortion());
  EXPECT_THROW(open_reel({.dataset = named})->load(0), InputError);  // a.png is missing
}

TEST_F(TumDatasetTest, RefusesAnUnknownCamera) {
  std::filesystem::remove(path() / "camera.yaml");
  EXPECT_NE(error().find("camera.yaml"), std::string::npos) << error();
}

TEST_F(TumDatasetTest, SaysWhereAListIsDamaged) {
  write_text(folder_ / "rgb.txt", "100.0 rgb/a.png\nnonsense\n");
  EXPECT_NE(error().find("rgb.txt:2: does not begin with a time"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "100.0 ../../etc/passwd\n");
  EXPECT_NE(error().find("names no file inside"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "100.0 /etc/passwd\n");
  EXPECT_NE(error().find("names no file inside"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "100.0\n");
  EXPECT_NE(error().find("names no file inside"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "nan rgb/a.png\n");
  EXPECT_NE(error().find("does not begin with a time"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "100.0 rgb/a.png\n99.0 rgb/b.png\n");
  EXPECT_NE(error().find("rgb.txt:2: is not later"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "# nothing\n");
  EXPECT_NE(error().find("lists no image"), std::string::npos) << error();
  write_text(folder_ / "rgb.txt", "500.0 rgb/a.png\n");
  EXPECT_NE(error().find("no colour image has a depth image"), std::string::npos) << error();
}

TEST_F(TumDatasetTest, ADamagedImageIsAnErrorOfThatFrame) {
  write_text(folder_ / "depth" / "a.png", "damaged");
  const auto reel = open_reel({.dataset = path()});
  EXPECT_THROW(reel->load(0), InputError);
  EXPECT_NO_THROW(reel->load(1));
  write_png(folder_ / "rgb" / "b.png", cv::Mat(12, 16, CV_8UC3));
  EXPECT_THROW(reel->load(1), InputError);
}

TEST_F(TumDatasetTest, OneImageByNumber) {
  EXPECT_EQ(open_reel({.dataset = path(), .image = 1})->size(), 1U);
  EXPECT_THROW(open_reel({.dataset = path(), .image = 2}), InputError);
}

}  // namespace
}  // namespace sextant
