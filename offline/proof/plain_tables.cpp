// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/plain_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

namespace sextant {
namespace {

/// Values of a plane with the border of one pixel.
struct Plane {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;
  std::uint16_t& at(int column, int row) {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
  std::uint16_t at(int column, int row) const { return const_cast<Plane*>(this)->at(column, row); }
};

Plane plane(const FrameTables& t, std::uint16_t value) {
  const int w = t.width() + 2, h = t.height() + 2;
  return {w, h, std::vector<std::uint16_t>(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value)};
}

/// Squared distance to the nearest feature no farther than `clip`: up and down each column, then all columns
/// near enough.
Plane distances(const FrameTables& t, const cv::Mat& edges, int kind) {
  const int clip = t.clip_radius();
  std::vector<int> column(static_cast<std::size_t>(t.width()) * static_cast<std::size_t>(t.height()),
                          clip + 1);
  const auto at = [&](int x, int y) -> int& {
    return column[static_cast<std::size_t>(y) * static_cast<std::size_t>(t.width()) +
                  static_cast<std::size_t>(x)];
  };
  for (int x = 0; x < t.width(); ++x) {
    for (int y = 0; y < t.height(); ++y) {
      if (((edges.at<std::uint8_t>(y, x) >> kind) & 1) == 0) continue;
      for (int d = -clip; d <= clip; ++d) {
        if (y + d >= 0 && y + d < t.height()) at(x, y + d) = std::min(at(x, y + d), std::abs(d));
      }
    }
  }
  Plane out = plane(t, FrameTables::kFar);
  for (int y = 0; y < t.height(); ++y) {
    for (int x = 0; x < t.width(); ++x) {
      int best = clip * clip + 1;
      for (int d = std::max(-clip, -x); d <= std::min(clip, t.width() - 1 - x); ++d) {
        const int up = at(x + d, y);
        if (up <= clip) best = std::min(best, d * d + up * up);
      }
      if (best <= clip * clip) out.at(x + 1, y + 1) = static_cast<std::uint16_t>(best);
    }
  }
  return out;
}

/// Minima (largest: maxima) of the windows of a side, clipped at the right and at the bottom: a queue of what
/// can still be the minimum, along rows, then along columns.
Plane windows(const Plane& exact, int side, bool largest) {
  const auto better = [largest](std::uint16_t a, std::uint16_t b) { return largest ? a >= b : a <= b; };
  Plane rows = exact, out = exact;
  std::deque<int> queue;
  const auto slide = [&](int length, auto value, auto store) {
    queue.clear();
    for (int i = length - 1; i >= 0; --i) {
      while (!queue.empty() && better(value(i), value(queue.back()))) queue.pop_back();
      queue.push_back(i);
      while (queue.front() >= i + side) queue.pop_front();
      store(i, value(queue.front()));
    }
  };
  for (int y = 0; y < exact.height; ++y) {
    slide(
        exact.width, [&](int i) { return exact.at(i, y); },
        [&](int i, std::uint16_t v) { rows.at(i, y) = v; });
  }
  for (int x = 0; x < exact.width; ++x) {
    slide(
        exact.height, [&](int i) { return rows.at(x, i); },
        [&](int i, std::uint16_t v) { out.at(x, i) = v; });
  }
  return out;
}

template <typename Level>
std::string wrong_levels(const Plane& exact, bool largest, const std::string& name, Level level) {
  for (std::size_t i = 0; i < kWindowSides.size(); ++i) {
    const Plane truth = i == 0 ? exact : windows(exact, kWindowSides[i], largest);
    const std::uint16_t* used = level(static_cast<int>(i));
    const auto [mine, its] = std::mismatch(truth.values.begin(), truth.values.end(), used);
    if (mine == truth.values.end()) continue;
    const auto index = static_cast<int>(mine - truth.values.begin());
    return fmt::format("table of {}, windows of {}, column {}, row {}: {} instead of {}", name,
                       kWindowSides[i], index % truth.width, index / truth.width, *its, *mine);
  }
  return "";
}

}  // namespace

std::string wrong_table(const FrameTables& t, const SearchFrame& frame, const cv::Mat& edges) {
  Plane nearest = plane(t, FrameTables::kMissing), farthest = plane(t, 0), missing = plane(t, 1);
  for (int y = 0; y < t.height(); ++y) {
    for (int x = 0; x < t.width(); ++x) {
      const float depth = frame.ray_depth_m.at<float>(y, x);
      if (!(depth > 0)) continue;
      const float steps = std::floor(depth / FrameTables::kDepthUnit + 0.5F);
      const auto value =
          static_cast<std::uint16_t>(std::clamp(steps, 1.0F, static_cast<float>(FrameTables::kLargestDepth)));
      nearest.at(x + 1, y + 1) = farthest.at(x + 1, y + 1) = value;
      missing.at(x + 1, y + 1) = 0;
    }
  }
  std::string wrong =
      wrong_levels(nearest, false, "nearest depth", [&](int i) { return t.nearest_depth(i); });
  if (wrong.empty()) {
    wrong = wrong_levels(farthest, true, "farthest depth", [&](int i) { return t.farthest_depth(i); });
  }
  if (wrong.empty()) {
    wrong = wrong_levels(missing, true, "missing depth", [&](int i) { return t.any_missing(i); });
  }
  for (int kind = 0; kind < 8 && wrong.empty(); ++kind) {
    wrong = wrong_levels(distances(t, edges, kind), false, fmt::format("edges {}", kind),
                         [&](int i) { return t.distance2(kind, i); });
  }
  return wrong;
}

}  // namespace sextant
