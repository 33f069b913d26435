// SPDX-License-Identifier: Apache-2.0
// Whole frames of a data set through features, tables and search: times, nodes, look-ups and the share of
// each stage; beside them, where asked for, the searches that this one replaces. scripts/bench search runs
// it.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/model/model_file.h"
#include "runtime/search/branch_and_bound.h"
#include "runtime/search/lanes/lane_search.h"
#include "runtime/search/reference/thesis_search.h"

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

struct Options {
  std::string model, dataset, scoring = "likelihood", json;
  int threads = 1, repeats = 1, most_images = 0;
  double tolerance_deg = 12, threshold_share = kDefaultEvidenceShare;
  bool free_space = false, each = false;
  double plain_s = 0, thesis_s = 0;  ///< time for the plain and the thesis's search of one image; 0: not run
};

/// Figures of one stage over all frames.
struct Series {
  std::string name, unit;
  std::vector<double> values{};
  double quantile(double q) const {
    if (values.empty()) return 0;
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    return sorted[std::min(sorted.size() - 1,
                           static_cast<std::size_t>(q * static_cast<double>(sorted.size())))];
  }
  void print() const {
    if (values.empty()) return;
    std::printf("%-28s median %12.3f  p99 %12.3f  max %12.3f %s\n", name.c_str(), quantile(0.5),
                quantile(0.99), quantile(1.0), unit.c_str());
  }
};

/// Runs another search of the same problem, best of all for at most `seconds`.
template <typename Search>
std::pair<SearchOutcome, double> timed(double seconds, SearchOptions options, Search search) {
  const double start = wall_seconds();
  options.expired = [&] { return wall_seconds() - start > seconds; };
  SearchOutcome outcome = search(options);
  return {std::move(outcome), wall_seconds() - start};
}

int run(const Options& o) {
  const ObjectModel model = read_model(o.model);
  BopDataset set = open_bop_dataset(o.dataset, "test");
  if (o.most_images > 0 && set.images.size() > static_cast<std::size_t>(o.most_images))
    set.images.resize(static_cast<std::size_t>(o.most_images));
  const Scoring scoring = scoring_from_name(o.scoring);

  WorkerPool pool(o.threads);
  const std::vector<ScoredBin> bins = score_bins(model, scoring);
  const double threshold = default_threshold(bins, o.threshold_share);
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
  Series features_ms{"features", "ms"}, exact_ms{"exact tables", "ms"}, lanes_ms{"lane tables", "ms"};
  Series search_ms{"search", "ms"}, search_cpu_ms{"search, processor", "ms"}, frame_ms{"frame to pose", "ms"};
  Series nodes{"nodes (64 cells each)", ""}, roots{"  of them roots", ""}, fine{"  of them fine", ""};
  Series parts{"parts (64 look-ups each)", ""}, evaluations{"exact evaluations", ""};
  Series waiting{"nodes waiting at once", ""};
  Series plain_ms{"plain search", "ms"}, plain_nodes{"plain search: regions", ""};
  Series thesis_ms{"thesis's search", "ms"}, thesis_nodes{"thesis's search: regions", ""};
  int plain_done = 0;
  int thesis_done = 0;
  int found = 0;
  for (const BopImage& image : set.images) {
    const RgbdFrame frame = load_frame(image);
    std::optional<TableConstraint> standing;
    if (!o.free_space)
      standing = TableConstraint{
          *frame.table, {TableTolerance{}.height_m, o.tolerance_deg * kOneDegree}, model.centre_height_m};
    double best_wall = std::numeric_limits<double>::infinity();
    double best_cpu = best_wall, best_features = best_wall, best_exact = best_wall, best_lanes = best_wall;
    for (int r = 0; r < o.repeats; ++r) {
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
      tables.build(rectified, edges, clip, pool, o.plain_s > 0);
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
        const SearchProblem plain{bins, tables, constraint, model.bounding_radius_m};
        const SearchOptions same{1, threshold, {}, {}};
        if (o.plain_s > 0) {
          const auto [other, seconds] = timed(
              o.plain_s, same, [&](const SearchOptions& s) { return branch_and_bound(plain, s, pool); });
          plain_ms.values.push_back(1e3 * seconds);
          plain_nodes.values.push_back(static_cast<double>(other.nodes));
          plain_done += other.complete ? 1 : 0;
          const bool agree = other.found.empty() == outcome[0].found.empty() &&
                             (other.found.empty() || other.found[0].pose == outcome[0].found[0].pose);
          if (other.complete && !agree) throw std::logic_error("the two searches disagree");
        }
        if (o.thesis_s > 0) {
          const auto [other, seconds] =
              timed(o.thesis_s, same, [&](const SearchOptions& s) { return thesis_search(plain, s); });
          thesis_ms.values.push_back(1e3 * seconds);
          thesis_nodes.values.push_back(static_cast<double>(other.nodes));
          thesis_done += other.complete ? 1 : 0;
        }
        if (o.each) {
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
    waiting.values.push_back(static_cast<double>(c.most_waiting));
    frame_ms.values.push_back(1e3 * (best_features + best_exact + best_lanes + best_wall));
  }
  std::printf("%zu images, found in %d, %d threads, %zu bins, tables %.1f MB\n", set.images.size(), found,
              pool.threads(), bins.size(), 1e-6 * static_cast<double>(lanes.bytes()));
  nlohmann::ordered_json out;
  out["images"] = set.images.size();
  out["found"] = found;
  out["threads"] = pool.threads();
  out["bins"] = bins.size();
  out["table_bytes"] = lanes.bytes();
  out["plain_finished"] = plain_done;
  out["thesis_finished"] = thesis_done;
  for (const Series* s :
       {&features_ms, &exact_ms, &lanes_ms, &search_ms, &search_cpu_ms, &frame_ms, &nodes, &roots, &fine,
        &parts, &evaluations, &waiting, &plain_ms, &plain_nodes, &thesis_ms, &thesis_nodes}) {
    s->print();
    if (s->values.empty()) continue;
    out["median"][s->name] = s->quantile(0.5);
    out["p99"][s->name] = s->quantile(0.99);
  }
  if (!plain_ms.values.empty()) std::printf("plain search finished in %d images\n", plain_done);
  if (!thesis_ms.values.empty()) std::printf("thesis's search finished in %d images\n", thesis_done);
  if (!o.json.empty()) std::ofstream(o.json) << out.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  sextant::Options o;
  CLI::App app{"Features, tables and search of whole frames: times and counts"};
  app.add_option("model", o.model)->required();
  app.add_option("dataset", o.dataset, "BOP data set with scene_table.json")->required();
  app.add_option("--threads", o.threads, "of the search")->capture_default_str();
  app.add_option("--repeats", o.repeats, "the best time of so many counts")->capture_default_str();
  app.add_option("--images", o.most_images, "the first so many; 0: all")->capture_default_str();
  app.add_option("--angle-tolerance-deg", o.tolerance_deg)->capture_default_str();
  app.add_option("--threshold-share", o.threshold_share, "of the evidence, that a pose must reach")
      ->capture_default_str();
  app.add_option("--scoring", o.scoring, "likelihood or thesis")->capture_default_str();
  app.add_flag("--no-table", o.free_space, "no table constraint");
  app.add_flag("--each", o.each, "a line for every image");
  app.add_option("--plain-s", o.plain_s, "also the plain search, at most so long an image");
  app.add_option("--thesis-s", o.thesis_s, "also the thesis's search, at most so long an image");
  app.add_option("--json", o.json, "write the figures here");
  CLI11_PARSE(app, argc, argv);
  try {
    return sextant::run(o);
  } catch (const sextant::DoorError& e) {
    std::fprintf(stderr, "sextant-engine-bench: %s\n", e.what());
    return static_cast<int>(e.exit_code());
  }
}
