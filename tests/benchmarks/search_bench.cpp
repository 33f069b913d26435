// SPDX-License-Identifier: Apache-2.0
// One bound of one region: window minima against the thesis's summed area tables and against exhaustion.
#include <benchmark/benchmark.h>

#include <limits>

#include "random_problem.h"
#include "runtime/search/bound.h"
#include "runtime/search/evaluate.h"
#include "runtime/search/reference/brute_force.h"
#include "runtime/search/reference/thesis_bound.h"

namespace sextant {
namespace {

constexpr double kNoFloor = -std::numeric_limits<double>::infinity();

std::vector<Region> regions_of(RandomProblem& p, int most) {
  std::vector<Region> out;
  for (int i = 0; i < 256; ++i) out.push_back(p.region(most));
  return out;
}

/// Mean distance of the bound from the best of sampled poses: what a looser bound costs in nodes.
template <typename Bound>
void run(benchmark::State& state, Bound bound) {
  RandomProblem p(7, 320, 240);
  const auto regions = regions_of(p, static_cast<int>(state.range(0)));
  const ThesisTables thesis(p.tables());
  std::size_t i = 0;
  for (auto _ : state) {
    const Region& r = regions[i++ % regions.size()];
    benchmark::DoNotOptimize(bound(p.bins()[static_cast<std::size_t>(r.bin)], p.tables(), thesis, r));
  }
  double slack = 0;
  for (const Region& r : regions) {
    const ScoredBin& bin = p.bins()[static_cast<std::size_t>(r.bin)];
    double best = kNoFloor;
    for (int k = 0; k < 200; ++k) best = std::max(best, evaluate(bin, p.tables(), p.pose_in(r)));
    slack += bound(bin, p.tables(), thesis, r) - best;
  }
  state.counters["slack"] = slack / static_cast<double>(regions.size());
}

void bm_window_bound(benchmark::State& state) {
  run(state, [](const ScoredBin& bin, const FrameTables& tables, const ThesisTables&, const Region& r) {
    return window_bound(bin, tables, r, kNoFloor);
  });
}
void bm_thesis_bound(benchmark::State& state) {
  run(state, [](const ScoredBin& bin, const FrameTables&, const ThesisTables& thesis, const Region& r) {
    return thesis_bound(bin, thesis, r);
  });
}
BENCHMARK(bm_window_bound)->Arg(2)->Arg(8)->Arg(16);
BENCHMARK(bm_thesis_bound)->Arg(2)->Arg(8)->Arg(16);

void bm_evaluate(benchmark::State& state) {
  RandomProblem p(7, 320, 240);
  const Region r = p.region(0);
  for (auto _ : state) {
    benchmark::DoNotOptimize(evaluate(p.bins()[static_cast<std::size_t>(r.bin)], p.tables(), r.first()));
  }
}
BENCHMARK(bm_evaluate);

}  // namespace
}  // namespace sextant
