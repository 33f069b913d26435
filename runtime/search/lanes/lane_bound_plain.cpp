// SPDX-License-Identifier: Apache-2.0
// The plain twin of the vector code in lane_bound.cpp: the same operations in the same order, one at a time.
#include <cmath>

#include "runtime/search/lanes/lane_node_frame.h"

namespace sextant {
namespace {

struct Span {
  float lo = 0, hi = 0;
};

Span linear_span(const std::array<std::array<float, kPartBlock>, 4>& c, std::size_t i,
                 const LaneNodeFrame& n) {
  const float middle = ((c[0][i] + c[1][i] * n.middle[0]) + c[2][i] * n.middle[1]) + c[3][i] * n.middle[2];
  const float half =
      (std::abs(c[1][i]) * n.half[0] + std::abs(c[2][i]) * n.half[1]) + std::abs(c[3][i]) * n.half[2];
  return {middle - half, middle + half};
}

/// The receptive field in codes of distance, at least one.
float visual_reach(float radius, const LaneNodeFrame& n) {
  return std::min(std::max(std::ceil(radius * n.codes), 1.0F), 65535.0F);
}

struct Origin {
  int at = 0, side = 0;
  bool outside = false;  ///< some lane may fall outside of the image
};
Origin origin_of(Span offset, float lane0, const LaneNodeFrame& n, const LaneStage& stage, int lanes,
                 int size) {
  const float lo = std::min(n.scale_lo * offset.lo, n.scale_hi * offset.lo);
  const float hi = std::max(n.scale_lo * offset.hi, n.scale_hi * offset.hi);
  const auto clamped = [](float v) { return std::min(std::max(v, -30000.0F), 30000.0F); };
  const int first = static_cast<int>(std::floor(clamped(lo + (lane0 + (0.5F - LaneNodeFrame::kPixelSlack)))));
  const int last = static_cast<int>(std::floor(clamped(hi + (lane0 + (0.5F + LaneNodeFrame::kPixelSlack)))));
  return {first, last + stage.cell - (first & ~(stage.grain - 1)),
          first < 0 || last + lanes * stage.cell > size};
}

struct Window {
  std::size_t level = 0;  ///< kLaneLevels: none is large enough
  std::size_t index = 0;
  bool outside = false;
};
Window window_of(Span u, Span v, const LaneTile& tile, const LaneNodeFrame& n, const LanePlanes& planes) {
  const Origin x = origin_of(u, static_cast<float>(tile.x0), n, planes.stage(), kLaneColumns, planes.width());
  const Origin y = origin_of(v, static_cast<float>(tile.y0), n, planes.stage(), kLaneRows, planes.height());
  const int side = std::max(x.side, y.side);
  std::size_t level = 0;
  for (const int window : planes.stage().windows) level += side > window * planes.stage().grain ? 1 : 0;
  return {level, planes.index_of(x.at, y.at), x.outside || y.outside};
}

std::uint16_t add_saturated(unsigned a, unsigned b) {
  return static_cast<std::uint16_t>(std::min(a + b, 65535U));
}
std::uint16_t less(unsigned a, unsigned b) { return static_cast<std::uint16_t>(a > b ? a - b : 0); }
unsigned high_product(unsigned a, unsigned b) { return (a * b) >> 16; }

template <typename Cost>
void add_costs(LaneCosts& out, const LanePlanes& planes, std::size_t index, Cost cost) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t at =
        index + lane / kLaneColumns * static_cast<std::size_t>(planes.columns()) + lane % kLaneColumns;
    out.units[lane] = add_saturated(out.units[lane], cost(lane, at));
  }
}

void add_visual(const VisualBlock& block, std::size_t i, const LaneNodeFrame& n, const LaneTile& tile,
                const LanePlanes& planes, LaneCosts& out) {
  const Window w = window_of(linear_span(block.u, i, n), linear_span(block.v, i, n), tile, n, planes);
  if (w.level == kLaneLevels) return;
  const float reach = visual_reach(block.radius[i], n);
  const auto reach_codes = static_cast<unsigned>(reach);
  const auto gain = static_cast<unsigned>(65535.0F / reach);
  const std::uint8_t* codes = planes.distance(static_cast<std::size_t>(block.kind[i]), w.level);
  add_costs(out, planes, w.index, [&](std::size_t, std::size_t at) {
    const unsigned share = std::min<unsigned>(codes[at], reach_codes) * gain;
    const unsigned cost = high_product(high_product(share, share), block.most[i]);
    return w.outside ? std::min<unsigned>(cost, block.outside[i]) : cost;
  });
}

void add_depth(const DepthBlock& block, std::size_t i, const LaneNodeFrame& n, const LaneTile& tile,
               const LanePlanes& planes, LaneCosts& out) {
  const Window w = window_of({block.px[i], block.px[i]}, {block.py[i], block.py[i]}, tile, n, planes);
  if (w.level == kLaneLevels) return;
  const Span d = linear_span(block.d, i, n);
  const auto clamped = [](float v) { return static_cast<int>(std::min(std::max(v, -65000.0F), 65000.0F)); };
  const int lowest = clamped(std::floor(d.lo - LaneNodeFrame::kDepthSlack));
  // Bit 0 of the nearest depth is a flag: it may read one step too deep.
  const int highest = clamped(std::floor(d.hi + (2.0F + LaneNodeFrame::kDepthSlack)));
  const std::uint16_t* nearest = planes.nearest(w.level);
  const std::uint16_t* farthest = planes.farthest(w.level);
  add_costs(out, planes, w.index, [&](std::size_t lane, std::size_t at) {
    const unsigned up = n.far ? 65535U : static_cast<unsigned>(std::max(highest, 0));
    const unsigned down = n.far ? 0U : static_cast<unsigned>(std::max(-highest, 0));
    const unsigned expected_hi = less(add_saturated(n.z_hi[lane], up), down);
    const unsigned expected_lo = less(add_saturated(n.z_lo[lane], static_cast<unsigned>(std::max(lowest, 0))),
                                      static_cast<unsigned>(std::max(-lowest, 0)));
    const unsigned behind = std::min<unsigned>(less(nearest[at], expected_hi), block.reach[i]);
    const unsigned before = std::min<unsigned>(less(expected_lo, farthest[at]), block.near_reach[i]);
    const unsigned share = std::max(behind, before) * block.gain[i];
    const unsigned cost = high_product(high_product(share, share), block.most[i]);
    return (nearest[at] & 1U) ? std::min<unsigned>(cost, block.missing[i]) : cost;
  });
}

}  // namespace

void lane_bound_plain(const LaneFrame& frame, const LaneBin& bin, const LaneTile& tile, const LaneNode& node,
                      std::uint16_t budget, LaneCosts& out) {
  const LaneNodeFrame n(frame, tile, node);
  const LanePlanes& planes = frame.tables.stage(node.stage);
  out.parts = 0;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    out.units[lane] = (n.alive >> lane) & 1U ? std::uint16_t{0} : std::uint16_t{65535};
  }
  const auto alive = [&] {
    std::uint64_t mask = 0;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      mask |= std::uint64_t{out.units[lane] <= budget} << lane;
    return mask;
  };
  out.alive = alive();
  for (std::size_t b = 0; b < bin.order.size() && out.alive != 0; ++b) {
    const std::size_t at = bin.order[b];
    for (std::size_t i = 0; i < kPartBlock; ++i) {
      if (at < bin.visual.size()) {
        add_visual(bin.visual[at], i, n, tile, planes, out);
      } else {
        add_depth(bin.depth[at - bin.visual.size()], i, n, tile, planes, out);
      }
    }
    out.parts += kPartBlock;
    out.alive = alive();
  }
}

}  // namespace sextant
