// SPDX-License-Identifier: Apache-2.0
// Whole frames of a data set through features, tables and search: times, nodes, look-ups and the share of
// each stage. sextant-engine-bench MODEL DATASET [threads] [repeats] [angle tolerance deg]
// [likelihood|thesis] [table|free]
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/model/model_file.h"
#include "runtime/search/lanes/lane_search.h"

namespace sextant {
namespace {

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Figures of one stage over all frames.
struct Series {
  std::vector<double> values;
  double quantile(double q) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1,
                           static_cast<std::size_t>(q * static_cast<double>(values.size())))];
  }
  void print(const char* name, const char* unit) {
    std::printf("%-28s median %10.3f  p99 %10.3f  max %10.3f %s\n", name, quantile(0.5), quantile(0.99),
                quantile(1.0), unit);
  }
};

int run(const std::vector<std::string>& arg) {
  const ObjectModel model = read_model(arg[1]);
  const BopDataset set = open_bop_dataset(arg[2], "test");
  const int threads = arg.size() > 3 ? std::stoi(arg[3]) : 1;
  const int repeats = arg.size() > 4 ? std::stoi(arg[4]) : 3;
  const double tolerance = arg.size() > 5 ? std::stod(arg[5]) * kOneDegree : TableTolerance{}.angle_rad;
  const Scoring scoring = scoring_from_name(arg.size() > 6 ? arg[6] : "likelihood");
  const bool free_space = arg.size() > 7 && arg[7] == "free";

  WorkerPool pool(threads);
  const std::vector<ScoredBin> bins = score_bins(model, scoring);
  const double threshold = default_threshold(bins);
  std::vector<LaneBin> lane_bins;
  double radius = 0;
  for (const ScoredBin& bin : bins) {
    lane_bins.push_back(lane_bin(bin, threshold));
    radius = std::max(radius, double{bin.largest_visual_radius});
  }
  FrameTables tables;
  LaneTables lanes;
  LaneSearch search;
  EdgeFinder edge_finder;
  Series features_ms, exact_ms, lanes_ms, search_ms, search_cpu_ms, nodes, fine, roots, parts, evaluations;
  int found = 0;
  for (const BopImage& image : set.images) {
    const RgbdFrame frame = load_frame(image);
    std::optional<TableConstraint> standing;
    if (!free_space)
      standing = TableConstraint{*frame.table, {TableTolerance{}.height_m, tolerance}, model.centre_height_m};
    double best_wall = std::numeric_limits<double>::infinity();
    double best_cpu = best_wall, best_features = best_wall, best_exact = best_wall, best_lanes = best_wall;
    for (int r = 0; r < repeats; ++r) {
      double t = wall_seconds();
      const SearchFrame rectified = sextant::rectified(frame);
      const cv::Mat edges = edge_finder.edges_by_direction(rectified.colour, kFrameEdges);
      best_features = std::min(best_features, wall_seconds() - t);
      const Constraint constraint(rectified.camera, 0.35, 3.0, standing);
      const int clip = std::clamp(static_cast<int>(std::ceil(radius * rectified.camera.focal /
                                                             constraint.nearest_feasible_distance())) +
                                      1,
                                  2, 200);
      t = wall_seconds();
      tables.build(rectified, edges, clip, pool, false);
      best_exact = std::min(best_exact, wall_seconds() - t);
      t = wall_seconds();
      lanes.build(tables, pool);
      best_lanes = std::min(best_lanes, wall_seconds() - t);
      LaneSearchProblem problem{tables, lanes, {}, {}};
      problem.targets.push_back({bins, lane_bins, constraint, model.bounding_radius_m, 1, threshold});
      t = wall_seconds();
      const double cpu = cpu_seconds();
      const auto outcome = search.run(problem, pool);
      best_cpu = std::min(best_cpu, cpu_seconds() - cpu);
      best_wall = std::min(best_wall, wall_seconds() - t);
      if (r == 0) {
        found += outcome[0].found.empty() ? 0 : 1;
        if (arg.size() > 8) {
          std::printf(
              "image %d: clip %d px, score %.3f of %.1f..%.1f, roots %lu coarse %lu fine %lu evaluated %lu\n",
              image.image_id, clip, outcome[0].found.empty() ? 0 : outcome[0].found[0].score, threshold,
              bins[0].offset, search.counters().roots, search.counters().coarse, search.counters().fine,
              search.counters().evaluations);
        }
      }
    }
    const LaneCounters& c = search.counters();
    features_ms.values.push_back(1e3 * best_features);
    exact_ms.values.push_back(1e3 * best_exact);
    lanes_ms.values.push_back(1e3 * best_lanes);
    search_ms.values.push_back(1e3 * best_wall);
    search_cpu_ms.values.push_back(1e3 * best_cpu);
    nodes.values.push_back(static_cast<double>(c.coarse + c.fine));
    fine.values.push_back(static_cast<double>(c.fine));
    roots.values.push_back(static_cast<double>(c.roots));
    parts.values.push_back(static_cast<double>(c.parts));
    evaluations.values.push_back(static_cast<double>(c.evaluations));
  }
  std::printf("%zu images, found in %d, %d threads, %zu bins\n", set.images.size(), found, pool.threads(),
              bins.size());
  features_ms.print("features", "ms");
  exact_ms.print("exact tables", "ms");
  lanes_ms.print("lane tables", "ms");
  search_ms.print("search", "ms");
  search_cpu_ms.print("search, processor", "ms");
  nodes.print("nodes (64 cells each)", "");
  roots.print("  of them roots", "");
  fine.print("  of them fine", "");
  parts.print("parts (64 look-ups each)", "");
  evaluations.print("exact evaluations", "");
  std::printf("tables %.1f MB\n", 1e-6 * static_cast<double>(lanes.bytes()));
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  const std::vector<std::string> arg(argv, argv + argc);
  if (arg.size() < 3) {
    std::fprintf(stderr,
                 "usage: sextant-engine-bench MODEL DATASET [threads] [repeats] [tolerance deg] [scoring] "
                 "[table|free] [each]\n");
    return 2;
  }
  try {
    return sextant::run(arg);
  } catch (const sextant::DoorError& e) {
    std::fprintf(stderr, "sextant-engine-bench: %s\n", e.what());
    return static_cast<int>(e.exit_code());
  }
}
