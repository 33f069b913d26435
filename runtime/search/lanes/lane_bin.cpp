// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/lanes/lane_bin.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/tables/frame_tables.h"

namespace sextant {
namespace {

constexpr double kUnits = 60000;
/// Floats of `evaluate` may round to a lower cost than real numbers: at most 1e-6 of all costs.
constexpr double kRoundingUnits = 1;

std::uint16_t units16(double value) { return static_cast<std::uint16_t>(std::clamp(value, 0.0, 65535.0)); }

/// Indices of parts, those with the largest cost first.
template <typename Cost>
std::vector<std::size_t> strongest_first(std::size_t count, Cost cost) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return cost(a) > cost(b); });
  return order;
}

template <typename Block>
double strength(const Block& block) {
  return std::accumulate(block.most.begin(), block.most.end(), 0.0);
}

}  // namespace

LaneBin lane_bin(const ScoredBin& bin, double floor) {
  LaneBin out;
  out.box = bin.box;
  out.offset = bin.offset;
  const double span = bin.offset - std::max(floor, bin.worst - 1);
  if (!(span > 0)) return out;
  const double s = kUnits / span;
  out.units_per_score = s;

  const VisualParts& visual = bin.visual;
  const auto visual_order =
      strongest_first(visual.size(), [&](std::size_t i) { return visual.radius2[i] * visual.weight[i]; });
  for (std::size_t n = 0; n < visual_order.size(); ++n) {
    if (n % kPartBlock == 0) out.visual.emplace_back();
    VisualBlock& block = out.visual.back();
    const std::size_t at = n % kPartBlock;
    const std::size_t i = visual_order[n];
    for (std::size_t c = 0; c < 4; ++c) {
      block.u[c][at] = visual.u[c][i];
      block.v[c][at] = visual.v[c][i];
    }
    block.kind[at] = visual.kind[i];
    const double weight = static_cast<double>(visual.weight[i]) * s;
    block.radius[at] = static_cast<float>(std::sqrt(static_cast<double>(visual.radius2[i])) * (1 + 1e-6));
    block.most[at] = units16(std::floor(static_cast<double>(visual.radius2[i]) * weight * (1 - 1e-6)));
    block.outside[at] = std::min(
        block.most[at], units16(std::floor(static_cast<double>(visual.outside_cost[i]) * s * (1 - 1e-6))));
  }

  const DepthParts& depth = bin.depth;
  const double step = FrameTables::kDepthUnit;
  const auto depth_order =
      strongest_first(depth.size(), [&](std::size_t i) { return depth.radius2[i] * depth.weight[i]; });
  for (std::size_t n = 0; n < depth_order.size(); ++n) {
    if (n % kPartBlock == 0) out.depth.emplace_back();
    DepthBlock& block = out.depth.back();
    const std::size_t at = n % kPartBlock;
    const std::size_t i = depth_order[n];
    block.px[at] = depth.px[i];
    block.py[at] = depth.py[i];
    double largest = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      block.d[c][at] = static_cast<float>(depth.d[c][i] / step);
      largest += std::abs(static_cast<double>(depth.d[c][i])) * (c == 0 ? 1 : std::numbers::pi);
    }
    out.largest_depth = std::max(out.largest_depth, largest);
    const double weight = static_cast<double>(depth.weight[i]) * s;
    const double reach =
        std::min(std::floor(std::sqrt(static_cast<double>(depth.radius2[i])) / step), 65535.0);
    block.reach[at] = units16(reach);
    block.near_reach[at] =
        units16(std::min(reach, std::floor(std::sqrt(static_cast<double>(depth.near_radius2[i])) / step)));
    block.gain[at] = reach > 0 ? units16(std::floor(65535 / reach)) : std::uint16_t{0};
    block.most[at] = units16(std::floor(reach * step * reach * step * weight * (1 - 1e-6)));
    block.missing[at] = units16(std::floor(static_cast<double>(depth.missing_cost[i]) * s * (1 - 1e-6)));
  }

  out.order.resize(out.visual.size() + out.depth.size());
  std::iota(out.order.begin(), out.order.end(), std::uint16_t{0});
  const auto strength_of = [&](std::uint16_t i) {
    return i < out.visual.size() ? strength(out.visual[i]) : strength(out.depth[i - out.visual.size()]);
  };
  std::stable_sort(out.order.begin(), out.order.end(),
                   [&](std::uint16_t a, std::uint16_t b) { return strength_of(a) > strength_of(b); });
  return out;
}

std::uint16_t budget_units(const LaneBin& bin, double score) {
  return static_cast<std::uint16_t>(
      std::clamp(std::ceil((bin.offset - score) * bin.units_per_score) + kRoundingUnits, 0.0, 65534.0));
}

double score_bound(const LaneBin& bin, std::uint16_t units) {
  return bin.offset - std::max(0.0, units - kRoundingUnits) / bin.units_per_score;
}

}  // namespace sextant
