// SPDX-License-Identifier: Apache-2.0
// The sensor model against the numbers that were measured on real frames, by the same measurement.
#include "offline/synthesize/depth_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>

#include "offline/synthesize/colour_sensor.h"
#include "offline/synthesize/noise_field.h"
#include "runtime/base/error.h"
#include "tests/unit/offline/synthesize/noise_statistics.h"

namespace sextant {
namespace {

/// Axial depth of a table seen from 0.6 m above it at 40 deg (or 0.35 m for long lenses), rows are level.
cv::Mat table_depth(double focal, double height_m, double pitch_rad = 0.7) {
  cv::Mat depth(480, 640, CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    const double py = (y - 239.5) / focal;
    const double z = height_m / (py * std::cos(pitch_rad) + std::sin(pitch_rad));
    depth.row(y) = cv::Scalar(z > 0 && z < 1.7 ? z : 0);
  }
  return depth;
}

NoiseStatistics measured(const DepthSensor& sensor, double height_m, int images) {
  NoiseStatistics sum;
  std::map<int, std::array<double, 2>> squares;
  for (int i = 0; i < images; ++i) {
    const cv::Mat clean = table_depth(sensor.focal_px, height_m);
    DepthSensor still = sensor;
    still.misregistration_px = 0;  // a shift of the whole image is no noise
    still.edge_jitter_px = 0;
    const cv::Mat noisy = apply_depth_sensor(clean, sensor.focal_px, still, static_cast<std::uint64_t>(i));
    const cv::Mat mask = (noisy > 0) & (clean > 0);
    const NoiseStatistics one = measure_noise((noisy - clean) * 1000, mask, clean);
    for (const auto& [key, row] : one.by_depth) {
      sum.by_depth[key].pixels += row.pixels;
      squares[key][0] += row.pixels * row.fast_mm * row.fast_mm;
      squares[key][1] += row.pixels * row.slow_mm * row.slow_mm;
    }
    sum.correlation_1 += one.correlation_1 / images;
    sum.correlation_4 += one.correlation_4 / images;
  }
  for (auto& [key, row] : sum.by_depth) {
    row.fast_mm = std::sqrt(squares[key][0] / row.pixels);
    row.slow_mm = std::sqrt(squares[key][1] / row.pixels);
  }
  return sum;
}

struct Measured {
  const char* sensor;
  double height_m;
  double correlation_1, correlation_4;
  std::vector<std::array<double, 3>> rows;  ///< depth [m], fast, slow [mm]
};

class RealNoise : public testing::TestWithParam<Measured> {};

TEST_P(RealNoise, IsReproduced) {
  const Measured& real = GetParam();
  const NoiseStatistics model = measured(depth_sensor(real.sensor), real.height_m, 6);
  EXPECT_NEAR(real.correlation_1, model.correlation_1, 0.03);
  EXPECT_NEAR(real.correlation_4, model.correlation_4, 0.05);
  for (const auto& [depth, fast, slow] : real.rows) {
    const auto row = model.by_depth.find(static_cast<int>(depth * 10));
    ASSERT_NE(model.by_depth.end(), row) << depth;
    ASSERT_GT(row->second.pixels, 3000) << depth;
    EXPECT_NEAR(fast, row->second.fast_mm, 0.15 * fast) << depth;
    EXPECT_NEAR(slow, row->second.slow_mm, 0.35 * slow) << depth;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, RealNoise,
    testing::Values(
        Measured{
            "kinect1",
            0.6,
            0.73,
            0.40,
            {{0.75, 1.24, 1.4}, {0.85, 1.53, 1.4}, {1.05, 2.21, 1.7}, {1.25, 3.16, 1.6}, {1.45, 3.99, 2.7}}},
        Measured{"xtion", 0.56, 0.92, 0.67, {{0.85, 1.55, 1.5}, {0.95, 2.1, 1.9}, {1.05, 2.55, 2.3}}},
        Measured{"realsense", 0.5, 0.955, 0.80, {{0.65, 0.95, 1.6}, {0.75, 1.4, 1.9}, {0.95, 2.15, 2.2}}}),
    [](const auto& test) { return test.param.sensor; });

TEST(DepthSensor, KinectStepsAreThoseOfItsDisparity) {
  const cv::Mat noisy = apply_depth_sensor(table_depth(525, 0.6), 525, depth_sensor("kinect1"), 1);
  std::map<int, std::set<int>> values;  // by 0.1 m, mm
  for (int y = 0; y < noisy.rows; ++y) {
    for (int x = 0; x < noisy.cols; ++x) {
      const float z = noisy.at<float>(y, x);
      if (z > 0) values[static_cast<int>(z * 10)].insert(static_cast<int>(std::lround(z * 1000)));
    }
  }
  // Steps of about 2.3 mm at 0.9 m and 5.6 mm at 1.4 m.
  EXPECT_NEAR(100.0 / 2.57, static_cast<double>(values[9].size()), 3);
  EXPECT_NEAR(100.0 / 6.0, static_cast<double>(values[14].size()), 2);
}

/// A wall at 1.0 m with a box 0.2 m in front of it.
cv::Mat step_scene() {
  cv::Mat depth(200, 300, CV_32FC1, cv::Scalar(1.0));
  depth(cv::Rect(120, 50, 60, 100)) = cv::Scalar(0.8);
  return depth;
}

TEST(DepthSensor, ShadowsLieBesideTheSilhouette) {
  DepthSensor sensor = depth_sensor("none");
  sensor.shadow_left_m = 0.07;
  const cv::Mat noisy = apply_depth_sensor(step_scene(), 600, sensor, 3);
  int left = 0;
  for (int y = 60; y < 140; ++y) {
    for (int x = 0; x < 300; ++x) {
      const bool missing = noisy.at<float>(y, x) == 0;
      EXPECT_TRUE(!missing || (x < 120 && x > 100)) << x;
      left += missing ? 1 : 0;
    }
  }
  // 600 px * 0.07 m * (1/0.8 - 1/1.0) per row.
  EXPECT_NEAR(10.5, left / 80.0, 1.0);
  sensor.shadow_left_m = 0;
  sensor.shadow_right_m = 0.07;
  const cv::Mat mirrored = apply_depth_sensor(step_scene(), 600, sensor, 3);
  EXPECT_EQ(0.0F, mirrored.at<float>(100, 184));
  EXPECT_EQ(1.0F, mirrored.at<float>(100, 115));
}

TEST(DepthSensor, EdgesAndBlobsGoMissingInAboutTheGivenShare) {
  DepthSensor sensor = depth_sensor("none");
  sensor.hole_share = 0.02;
  const cv::Mat flat(480, 640, CV_32FC1, cv::Scalar(1.0));
  EXPECT_NEAR(0.02, 1 - cv::countNonZero(apply_depth_sensor(flat, 525, sensor, 5)) / (480.0 * 640), 0.006);
  sensor.hole_share = 0;
  sensor.edge_loss_px = 4;
  const cv::Mat noisy = apply_depth_sensor(step_scene(), 525, sensor, 5);
  const double lost = 200.0 * 300 - cv::countNonZero(noisy);
  EXPECT_GT(lost, 2 * 320);
  EXPECT_LT(lost, 8 * 320);
  EXPECT_GT(noisy.at<float>(20, 20), 0.0F);
}

TEST(DepthSensor, NoneChangesNothingAndMissingStaysMissing) {
  cv::Mat depth = table_depth(525, 0.6);
  depth.at<float>(100, 100) = 0;
  EXPECT_EQ(0, cv::norm(depth, apply_depth_sensor(depth, 525, depth_sensor("none"), 9), cv::NORM_INF));
  for (const char* name : {"kinect1", "xtion", "realsense"}) {
    DepthSensor sensor = depth_sensor(name);
    sensor.misregistration_px = sensor.edge_jitter_px = 0;
    EXPECT_EQ(0.0F, apply_depth_sensor(depth, 525, sensor, 9).at<float>(100, 100));
  }
}

TEST(DepthSensor, IsAFunctionOfTheSeed) {
  const cv::Mat depth = table_depth(525, 0.6);
  const DepthSensor sensor = depth_sensor("kinect1");
  const cv::Mat a = apply_depth_sensor(depth, 525, sensor, 1);
  EXPECT_EQ(0, cv::norm(a, apply_depth_sensor(depth, 525, sensor, 1), cv::NORM_INF));
  EXPECT_LT(0, cv::norm(a, apply_depth_sensor(depth, 525, sensor, 2), cv::NORM_INF));
  EXPECT_THROW(depth_sensor("kinect9"), UsageError);
}

TEST(NoiseField, HasUnitVarianceAndTheStatedCorrelation) {
  for (const double sigma : {1.0, 1.5, 4.0, 9.0}) {
    Random random(7);
    const cv::Mat field = smooth_noise({900, 700}, sigma, random);
    cv::Scalar mean;
    cv::Scalar deviation;
    cv::meanStdDev(field, mean, deviation);
    EXPECT_NEAR(1, deviation[0], 0.07) << sigma;
    const int d = std::max(1, static_cast<int>(sigma * 2));
    const cv::Mat a = field(cv::Rect(0, 0, 900 - d, 700));
    const cv::Mat b = field(cv::Rect(d, 0, 900 - d, 700));
    const double correlation = a.dot(b) / static_cast<double>(a.total()) / (deviation[0] * deviation[0]);
    EXPECT_NEAR(std::exp(-d * d / (4 * sigma * sigma)), correlation, 0.06) << sigma;
  }
}

TEST(DepthSensor, ObjectsLoseTheirShareAndTheTableDoesNot) {
  DepthSensor sensor = depth_sensor("none");
  sensor.object_hole_lo = sensor.object_hole_hi = 0.2;
  const cv::Mat depth(240, 320, CV_32FC1, cv::Scalar(0.9));
  DepthSurfaces surfaces;
  surfaces.object = cv::Mat(240, 320, CV_16SC1, cv::Scalar(-1));
  const cv::Rect first(20, 20, 130, 200);
  const cv::Rect second(170, 20, 130, 200);
  surfaces.object(first).setTo(0);
  surfaces.object(second).setTo(1);
  surfaces.no_depth = {1};
  const cv::Mat noisy = apply_depth_sensor(depth, 525, sensor, 4, surfaces);
  EXPECT_NEAR(0.8, cv::countNonZero(noisy(first)) / static_cast<double>(first.area()), 0.06);
  EXPECT_LT(cv::countNonZero(noisy(second)), 0.15 * second.area());
  const int outside = static_cast<int>(depth.total()) - first.area() - second.area();
  EXPECT_EQ(outside,
            cv::countNonZero(noisy) - cv::countNonZero(noisy(first)) - cv::countNonZero(noisy(second)));
}

TEST(DepthSensor, HolesMoveWithTheDepthWhenItIsMisregistered) {
  DepthSensor sensor = depth_sensor("none");
  sensor.focal_px = 525;
  sensor.misregistration_px = 6;
  const cv::Mat depth(240, 320, CV_32FC1, cv::Scalar(0.9));
  DepthSurfaces surfaces;
  surfaces.object = cv::Mat(240, 320, CV_16SC1, cv::Scalar(-1));
  surfaces.object(cv::Rect(100, 80, 60, 60)).setTo(0);
  surfaces.no_depth = {0};
  double squares = 0;
  constexpr int kSeeds = 40;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    const cv::Moments m = cv::moments(apply_depth_sensor(depth, 525, sensor, seed, surfaces) == 0, true);
    squares += std::pow(m.m10 / m.m00 - 129.5, 2);
  }
  // The spread of the mean square of 40 normal numbers is 22 %.
  EXPECT_NEAR(36, squares / kSeeds, 24);
}

TEST(ColourSensor, ExposesToItsRangeOfBrightnessAndAddsItsNoise) {
  ColourSensor sensor;
  sensor.gamma = sensor.vignetting = sensor.saturation = sensor.flicker = 0;
  for (const int level : {40, 120, 220}) {
    const cv::Mat grey(300, 400, CV_8UC3, cv::Scalar::all(level));
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      cv::Scalar mean;
      cv::Scalar deviation;
      const cv::Mat seen = apply_colour_sensor(grey, sensor, seed);
      cv::meanStdDev(seen(cv::Rect(150, 100, 100, 100)), mean, deviation);
      for (int c = 0; c < 3; ++c) {
        EXPECT_GT(mean[c], std::max(75.0, 0.5 * level) * 0.9);
        EXPECT_LT(mean[c], std::min(std::max(150.0, 0.5 * level), 3.0 * level) * 1.1);
        EXPECT_GT(deviation[c], 0.9);
        EXPECT_LT(deviation[c], 6.5);
      }
      EXPECT_EQ(0, cv::norm(seen, apply_colour_sensor(grey, sensor, seed), cv::NORM_INF));
    }
  }
}

TEST(ColourSensor, MotionBlurKeepsTheLightAndWidensEdges) {
  cv::Mat step(200, 200, CV_8UC3, cv::Scalar::all(60));
  step(cv::Rect(100, 0, 100, 200)).setTo(cv::Scalar::all(180));
  ColourSensor still;
  still.gamma = still.vignetting = still.saturation = still.flicker = still.white_balance = 0;
  still.brightness_min = still.brightness_max = 120;
  still.noise_min = still.noise_max = 0;
  still.motion_chance = 0;
  ColourSensor moving = still;
  moving.motion_chance = 1;
  moving.motion_px = 30;
  double widest = 0;
  const auto width = [](const cv::Mat& image) {
    int between = 0;
    for (int x = 0; x < image.cols; ++x) {
      const int v = image.at<cv::Vec3b>(100, x)[0];
      between += v > 75 && v < 165 ? 1 : 0;
    }
    return between;
  };
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const cv::Mat blurred = apply_colour_sensor(step, moving, seed);
    EXPECT_NEAR(120, cv::mean(blurred)[0], 2);
    widest = std::max<double>(widest, width(blurred));
    EXPECT_LE(width(apply_colour_sensor(step, still, seed)), 5);
  }
  EXPECT_GT(widest, 8);
}

}  // namespace
}  // namespace sextant
