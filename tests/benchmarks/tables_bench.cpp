// SPDX-License-Identifier: Apache-2.0
// Features and tables of a 640 x 480 frame; the distance transform against OpenCV's.
#include <benchmark/benchmark.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "random_problem.h"
#include "runtime/features/edges.h"
#include "runtime/tables/distance_transform.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {
namespace {

void bm_edges(benchmark::State& state) {
  const RandomProblem p(3, 640, 480);
  EdgeFinder finder;
  for (auto _ : state) benchmark::DoNotOptimize(finder.edges_by_direction(p.frame().colour, kFrameEdges));
}
BENCHMARK(bm_edges)->Unit(benchmark::kMillisecond);

/// The same from OpenCV's filters.
void bm_edges_opencv(benchmark::State& state) {
  const RandomProblem p(3, 640, 480);
  cv::Mat edges;
  for (auto _ : state) {
    const Gradient gradient = strongest_gradient_plain(p.frame().colour);
    cv::Canny(gradient.dx, gradient.dy, edges, 60, 120, true);
    benchmark::DoNotOptimize(edges.data);
  }
}
BENCHMARK(bm_edges_opencv)->Unit(benchmark::kMillisecond);

void bm_tables(benchmark::State& state) {
  const RandomProblem p(3, 640, 480);
  FrameTables tables;
  WorkerPool pool(static_cast<int>(state.range(1)));
  for (auto _ : state) tables.build(p.frame(), p.edges(), static_cast<int>(state.range(0)), pool);
}
BENCHMARK(bm_tables)->Args({15, 1})->Args({15, 2})->Args({30, 2})->UseRealTime()->Unit(
    benchmark::kMillisecond);

void bm_distance_transform(benchmark::State& state) {
  const RandomProblem p(3, 640, 480);
  std::vector<std::uint16_t> out(640 * 480);
  for (auto _ : state) clipped_distance2(p.edges(), 0, 15, out.data(), 640);
}
BENCHMARK(bm_distance_transform)->Unit(benchmark::kMillisecond);

void bm_distance_transform_opencv(benchmark::State& state) {
  const RandomProblem p(3, 640, 480);
  cv::Mat zeros = (p.edges() & 1) == 0;
  cv::Mat out;
  for (auto _ : state) cv::distanceTransform(zeros, out, cv::DIST_L2, cv::DIST_MASK_PRECISE);
}
BENCHMARK(bm_distance_transform_opencv)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant
