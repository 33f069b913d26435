// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/evaluate.h"

#include "runtime/search/part_arithmetic.h"

namespace sextant {

double evaluate(const ScoredBin& bin, const FrameTables& tables, const LatticePose& pose) {
  const float x = lattice_pixel(pose.at[kX]);
  const float y = lattice_pixel(pose.at[kY]);
  const float z = lattice_distance(pose.at[kZ]);
  const float rx = lattice_angle(pose.at[kRx]);
  const float ry = lattice_angle(pose.at[kRy]);
  const float rz = lattice_angle(pose.at[kRz]);
  const auto focal = static_cast<float>(tables.camera().focal);
  const float scale = focal / z;  // pixels per (tangent * metre)
  const float unit = z / focal;   // and back
  const float unit2 = unit * unit;
  const int stride = tables.stride();
  double cost = 0;

  const VisualParts& visual = bin.visual;
  for (std::size_t i = 0; i < visual.size(); ++i) {
    const float u = linear(visual.u[0][i], visual.u[1][i], visual.u[2][i], visual.u[3][i], rx, ry, rz);
    const float v = linear(visual.v[0][i], visual.v[1][i], visual.v[2][i], visual.v[3][i], rx, ry, rz);
    const int column = table_index(x + scale * u, tables.width());
    const int row = table_index(y + scale * v, tables.height());
    if (is_outside(column, row, tables)) {
      cost += static_cast<double>(visual.outside_cost[i]);
      continue;
    }
    const auto distance2 = static_cast<float>(tables.distance2(visual.kind[i], 0)[row * stride + column]);
    cost += static_cast<double>(std::min(distance2 * unit2, visual.radius2[i]) * visual.weight[i]);
  }

  const DepthParts& depth = bin.depth;
  const std::uint16_t* nearest = tables.nearest_depth(0);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const int column = table_index(x + scale * depth.px[i], tables.width());
    const int row = table_index(y + scale * depth.py[i], tables.height());
    const std::uint16_t steps = nearest[row * stride + column];
    if (steps == FrameTables::kMissing) {
      cost += static_cast<double>(depth.missing_cost[i]);
      continue;
    }
    const float expected = z + linear(depth.d[0][i], depth.d[1][i], depth.d[2][i], depth.d[3][i], rx, ry, rz);
    const float difference = static_cast<float>(steps) * FrameTables::kDepthUnit - expected;
    const float radius2 = difference < 0 ? depth.near_radius2[i] : depth.radius2[i];
    cost += static_cast<double>(std::min(difference * difference, radius2) * depth.weight[i]);
  }
  return bin.offset - cost;
}

}  // namespace sextant
