// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/reference/thesis_search.h"

#include <algorithm>
#include <limits>
#include <queue>

#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"
#include "runtime/search/reference/thesis_bound.h"

namespace sextant {
namespace {

/// Minimum resolution region: 2 px, 2 px, 2 cm, 4 deg, 4 deg, 4 deg, in lattice poses (sec. 5.3.5).
constexpr std::array<int, kDimensions> kMinimumResolution{2, 2, 10, 4, 4, 4};

bool at_minimum_resolution(const Region& r) {
  for (std::size_t d = 0; d < kDimensions; ++d) {
    if (r.hi[d] - r.lo[d] + 1 > kMinimumResolution[d]) return false;
  }
  return true;
}

/// BRANCH (sec. 5.3.1): every combination of halves; dimensions of one lattice pose are not divided.
std::vector<Region> branch(const Region& r) {
  std::vector<Region> parts{r};
  for (std::size_t d = 0; d < kDimensions; ++d) {
    if (r.lo[d] == r.hi[d]) continue;
    const auto middle = static_cast<std::int16_t>((r.lo[d] + r.hi[d]) >> 1);
    const std::size_t count = parts.size();
    for (std::size_t i = 0; i < count; ++i) {
      Region upper = parts[i];
      parts[i].hi[d] = middle;
      upper.lo[d] = static_cast<std::int16_t>(middle + 1);
      parts.push_back(upper);
    }
  }
  return parts;
}

struct Node {
  double bound = 0;
  bool exact = false;
  Region region;
};
struct Later {
  bool operator()(const Node& a, const Node& b) const {
    if (a.bound != b.bound) return a.bound < b.bound;
    if (a.exact != b.exact) return a.exact;
    return b.region.first() < a.region.first();
  }
};

}  // namespace

SearchOutcome thesis_search(const SearchProblem& problem, const SearchOptions& options) {
  const ThesisTables tables(problem.tables);
  std::priority_queue<Node, std::vector<Node>, Later> queue;
  SearchOutcome outcome;
  const auto push = [&](const Region& region) {
    const Region r = problem.constraint.tightened(region);
    if (r.empty()) return;
    ++outcome.nodes;
    const double bound = thesis_bound(problem.bins[static_cast<std::size_t>(r.bin)], tables, r);
    if (bound >= options.threshold) queue.push({bound, false, r});
  };
  for (std::size_t i = 0; i < problem.bins.size(); ++i) {
    push(problem.constraint.whole(static_cast<int>(i), problem.bins[i].box));
  }
  outcome.complete = true;
  outcome.upper_bound = options.threshold;
  while (!queue.empty()) {
    const Node node = queue.top();
    if (node.exact) {
      outcome.found.push_back({node.region.first(), node.bound});
      outcome.upper_bound = std::max(options.threshold, node.bound);
      return outcome;
    }
    if (options.expired && options.expired()) {
      outcome.complete = false;
      outcome.upper_bound = std::max(options.threshold, node.bound);
      return outcome;
    }
    queue.pop();
    if (!at_minimum_resolution(node.region)) {
      for (const Region& part : branch(node.region)) push(part);
      continue;
    }
    // The best pose of the region goes back, and with it what ties with it elsewhere is still to come.
    const ScoredBin& bin = problem.bins[static_cast<std::size_t>(node.region.bin)];
    Node best{-std::numeric_limits<double>::infinity(), true, {}};
    for_each_pose(node.region, [&](const LatticePose& pose) {
      if (!problem.constraint.contains(pose)) return;
      const double score = evaluate(bin, problem.tables, pose);
      ++outcome.nodes;
      if (score > best.bound) best = {score, true, {pose.bin, pose.at, pose.at}};
    });
    if (best.bound >= options.threshold) queue.push(best);
  }
  return outcome;
}

}  // namespace sextant
