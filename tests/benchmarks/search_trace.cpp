// SPDX-License-Identifier: Apache-2.0
// The tree of one frame's search, node by node with what each cost, for the simulation of many workers
// (tests/benchmarks/scaling.py).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "runtime/detect/detector.h"
#include "runtime/model/model_file.h"
#include "runtime/search/lanes/frontier.h"

namespace sextant {
namespace {

constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A node's box: no two nodes of a search have the same.
using Box = std::array<int, 12>;
Box box_of(const LaneNode& n) {
  return {n.bin,   n.x0,    n.y0,    n.offset_lo, n.offset_hi, n.stage,
          n.lo[0], n.lo[1], n.lo[2], n.hi[0],     n.hi[1],     n.hi[2]};
}

/// Searches on one thread, one node at a time, and writes what it saw.
std::vector<SearchOutcome> traced(const LaneSearchProblem& problem, double prepare_s, std::ofstream& out) {
  nlohmann::ordered_json head;
  head["prepare_s"] = prepare_s;
  LaneSearch engine;
  for (std::size_t count = 1; count <= 1024; count *= 2) {
    const double start = seconds();
    engine.begin(problem, {0, count});
    head["begin_s"][std::to_string(count)] = seconds() - start;
    engine.finish(false, {});
  }
  engine.begin(problem, {0, 1});
  const double threshold = problem.targets.at(0).threshold;
  const auto wanted = [&] { return std::max(threshold, engine.bests()[0].score); };
  head["threshold"] = threshold;
  head["best_at_begin"] = wanted();
  double ceiling = -std::numeric_limits<double>::infinity();
  for (const LaneBin& bin : problem.targets[0].lane_bins) ceiling = std::max(ceiling, bin.offset);
  head["ceiling"] = ceiling;
  // The engine's own order: its frontier's.
  Frontier waiting;
  waiting.set_range(threshold, ceiling);
  std::vector<LaneNode> nodes;
  std::map<Box, std::size_t> ids;
  std::vector<std::int64_t> parents;
  const auto put = [&](const std::vector<LaneNode>& children, std::int64_t parent) {
    for (const LaneNode& node : children) {
      waiting.put(node);
      ids.emplace(box_of(node), nodes.size());
      nodes.push_back(node);
      parents.push_back(parent);
    }
  };
  put(engine.give(kAll), -1);
  std::vector<double> cost(nodes.size(), 0), best_after(nodes.size(), 0);
  while (!waiting.empty()) {
    const LaneNode node = waiting.take();
    if (static_cast<double>(node.bound) < wanted()) continue;
    const std::size_t id = ids.at(box_of(node));
    engine.take({node});
    const double start = seconds();
    engine.step(1);
    const double took = seconds() - start;
    put(engine.give(kAll), static_cast<std::int64_t>(id));
    cost.resize(nodes.size(), 0);
    best_after.resize(nodes.size(), 0);
    cost[id] = took;
    best_after[id] = wanted();
  }
  out << head.dump() << '\n';
  // node: parent, bound, tile, microseconds (0: never expanded), best score after it
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    char line[160];
    std::snprintf(line, sizeof line, "%lld,%.9g,%d,%.3f,%.9g\n", static_cast<long long>(parents[i]),
                  static_cast<double>(nodes[i].bound), nodes[i].y0 / 32 * 64 + nodes[i].x0 / 128,
                  1e6 * cost[i], best_after[i]);
    out << line;
  }
  engine.advance(engine.bests());
  return engine.finish(true, {});
}

struct Options {
  std::string model, dataset, out;
  int image = 0;
  double tolerance_deg = 12;
};

int run(const Options& o) {
  DetectOptions options;
  options.threads = 1;
  options.refine = false;
  options.runner_up = false;
  options.tolerance.angle_rad = o.tolerance_deg * 3.14159265358979 / 180;
  std::vector<ObjectModel> models;
  models.push_back(read_model(o.model));
  Detector detector(std::move(models), options);
  for (const BopImage& image : open_bop_dataset(o.dataset, "test").images) {
    if (image.image_id != o.image) continue;
    const RgbdFrame frame = load_frame(image);
    detector.detect(frame);  // warms up
    const double start = seconds();
    DetectCall call;
    std::ofstream out(o.out);
    call.search = [&](const LaneSearchProblem& problem, const DetectCall&) {
      return traced(problem, seconds() - start, out);
    };
    const FrameResult result = detector.detect(frame, call);
    std::printf("%s: %s\n", o.out.c_str(), result.estimates.empty() ? "absent" : "found");
    return 0;
  }
  throw InputError(o.dataset, "has no image " + std::to_string(o.image));
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  sextant::Options o;
  CLI::App app{"The tree of one frame's search"};
  app.add_option("model", o.model)->required();
  app.add_option("dataset", o.dataset, "BOP data set with scene_table.json")->required();
  app.add_option("--image", o.image)->capture_default_str();
  app.add_option("--angle-tolerance-deg", o.tolerance_deg)->capture_default_str();
  app.add_option("--out", o.out)->required();
  CLI11_PARSE(app, argc, argv);
  try {
    return sextant::run(o);
  } catch (const sextant::DoorError& e) {
    std::fprintf(stderr, "sextant-search-trace: %s\n", e.what());
    return static_cast<int>(e.exit_code());
  }
}
