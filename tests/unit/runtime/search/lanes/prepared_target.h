// SPDX-License-Identifier: Apache-2.0
// A target of the engine with its prepared bins, and a run of the engine on it.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "runtime/search/lanes/lane_search.h"

namespace sextant {

/// A target with its prepared bins.
struct PreparedTarget {
  std::vector<LaneBin> lane_bins;
  LaneTarget target;

  PreparedTarget(const std::vector<ScoredBin>& bins, const Constraint& constraint, int wanted,
                 double threshold)
      : lane_bins(prepare(bins, threshold)), target{bins, lane_bins, constraint, 0.1, wanted, threshold} {}
  static std::vector<LaneBin> prepare(const std::vector<ScoredBin>& bins, double threshold) {
    std::vector<LaneBin> out;
    for (const ScoredBin& bin : bins) out.push_back(lane_bin(bin, threshold));
    return out;
  }
};

inline SearchOutcome run_lanes(const FrameTables& exact, const PreparedTarget& prepared, WorkerPool& pool,
                               std::function<bool()> expired = {}, std::size_t most_waiting = 200000) {
  LaneTables lanes;
  lanes.build(exact, pool);
  LaneSearch engine;
  return engine.run({exact, lanes, {prepared.target}, std::move(expired), most_waiting}, pool)[0];
}

}  // namespace sextant
