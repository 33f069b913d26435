// SPDX-License-Identifier: Apache-2.0
// From two images to what the search wants: registration, rectification, the table. The plain twin moves one
// point per depth pixel in doubles, without footprints.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "hal/pairing/frame_composer.h"
#include "hal/pairing/stream_synchroniser.h"
#include "runtime/frame/table_estimate.h"

namespace sextant {
namespace {

CameraModel camera(int width, double focal_share, double lens) {
  CameraModel c;
  c.width = width;
  c.height = width == 1280 ? 720 : width * 3 / 4;
  c.fx = focal_share * width;
  c.fy = 0.995 * c.fx;
  c.cx = 0.49 * c.width;
  c.cy = 0.51 * c.height;
  if (lens != 0) c.distortion = {lens, -0.5 * lens, 0.0005, -0.0003, 0};
  return c;
}

/// Colour and depth of the same size, both with a lens, 5 cm apart.
struct Rig {
  RgbdCalibration calibration;
  cv::Mat colour, depth;

  explicit Rig(int width) {
    calibration.colour = camera(width, 0.82, 0.08);
    calibration.depth = camera(width, 0.9, 0.02);
    calibration.colour_from_depth.linear() =
        Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix();
    calibration.colour_from_depth.translation() = Eigen::Vector3d(-0.05, 0.001, 0.002);
    const CameraModel& c = calibration.colour;
    const CameraModel& d = calibration.depth;
    colour = cv::Mat(c.height, c.width, CV_8UC3);
    cv::randu(colour, 0, 255);
    depth = cv::Mat::zeros(d.height, d.width, CV_32FC1);
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, 0.002);
    const TableGeometry table = TableGeometry::from_pitch_roll(0.7, 0, 0.6);
    for (int y = 0; y < d.height; ++y) {
      for (int x = 0; x < d.width; ++x) {
        const double down = -table.up_in_camera.dot(Eigen::Vector3d((x - d.cx) / d.fx, (y - d.cy) / d.fy, 1));
        if (random() % 20 == 0 || down < 0.25) continue;
        depth.at<float>(y, x) = static_cast<float>(table.camera_height_m / down + noise(random));
      }
    }
  }
};

void per_second(benchmark::State& state) {
  // The share of one core at 30 frames a second.
  state.counters["core_at_30Hz"] = benchmark::Counter(
      1.0 / 30, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void bm_registration(benchmark::State& state) {
  const Rig rig(static_cast<int>(state.range(0)));
  CameraModel target = rig.calibration.colour;
  target.distortion = {};
  DepthRegistration registration(rig.calibration.depth, target, rig.calibration.colour_from_depth, "bench");
  for (auto _ : state) benchmark::DoNotOptimize(registration.registered(rig.depth));
  per_second(state);
}
BENCHMARK(bm_registration)->Arg(640)->Arg(1280)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void bm_registration_plain(benchmark::State& state) {
  const Rig rig(static_cast<int>(state.range(0)));
  const CameraModel& d = rig.calibration.depth;
  const CameraModel& c = rig.calibration.colour;
  for (auto _ : state) {
    cv::Mat out = cv::Mat::zeros(c.height, c.width, CV_32FC1);
    for (int y = 0; y < d.height; ++y) {
      for (int x = 0; x < d.width; ++x) {
        const double z = rig.depth.at<float>(y, x);
        if (!(z > 0)) continue;
        const Eigen::Vector3d p = rig.calibration.colour_from_depth *
                                  Eigen::Vector3d(z * (x - d.cx) / d.fx, z * (y - d.cy) / d.fy, z);
        const auto u = static_cast<int>(std::lround(c.fx * p.x() / p.z() + c.cx));
        const auto v = static_cast<int>(std::lround(c.fy * p.y() / p.z() + c.cy));
        if (u < 0 || v < 0 || u >= c.width || v >= c.height) continue;
        float& at = out.at<float>(v, u);
        if (at == 0 || p.z() < at) at = static_cast<float>(p.z());
      }
    }
    benchmark::DoNotOptimize(out);
  }
  per_second(state);
}
BENCHMARK(bm_registration_plain)->Arg(640)->Arg(1280)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// All that a pair of images costs between the sources and the search: pairing, registration, rectification
/// of both, axial to ray depth.
void bm_pair_to_search(benchmark::State& state) {
  const Rig rig(static_cast<int>(state.range(0)));
  FrameComposer composer(rig.calibration, {.rectify = true, .width = static_cast<int>(state.range(1))},
                         "bench");
  StreamSynchroniser<cv::Mat> synchroniser;
  cv::setNumThreads(1);
  Rectifier rectifier;
  // What depends on the calibration alone is made with the first frame.
  benchmark::DoNotOptimize(rectifier.rectified(composer.compose(rig.colour, rig.depth)));
  std::int64_t i = 0;
  for (auto _ : state) {
    ++i;
    synchroniser.push(Stream::kColour, std::chrono::milliseconds(33 * i), i, rig.colour);
    synchroniser.push(Stream::kDepth, std::chrono::milliseconds(33 * i + 5), i, rig.depth);
    while (const auto pair = synchroniser.pop()) {
      benchmark::DoNotOptimize(rectifier.rectified(composer.compose(pair->colour, pair->depth)));
    }
  }
  per_second(state);
}
BENCHMARK(bm_pair_to_search)
    ->ArgNames({"camera", "search"})
    ->Args({640, 640})
    ->Args({1280, 1280})
    ->Args({1280, 640})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

void bm_table_estimate(benchmark::State& state) {
  const Rig rig(640);
  FrameComposer composer(rig.calibration, {.rectify = true}, "bench");
  const SearchFrame frame = rectified(composer.compose(rig.colour, rig.depth));
  for (auto _ : state) benchmark::DoNotOptimize(estimate_table(frame));
}
BENCHMARK(bm_table_estimate)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace sextant
