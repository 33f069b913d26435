// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/constraint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

constexpr double kSlack = 1e-7;  ///< lattice steps; swallows the rounding of index computations

std::int16_t first_at_or_above(double value) {
  return static_cast<std::int16_t>(std::clamp(std::ceil(value - kSlack), -32000.0, 32000.0));
}
std::int16_t last_at_or_below(double value) {
  return static_cast<std::int16_t>(std::clamp(std::floor(value + kSlack), -32000.0, 32000.0));
}

void shrink(Region& region, Dimension d, Interval range, double step) {
  region.lo[d] = std::max(region.lo[d], first_at_or_above(range.lo / step));
  region.hi[d] = std::min(region.hi[d], last_at_or_below(range.hi / step));
}

bool box_holds(const RotationBox& box, double rx_deg, double ry_deg) {
  return box.lo_deg[0] <= rx_deg && rx_deg < box.hi_deg[0] && box.lo_deg[1] <= ry_deg &&
         ry_deg < box.hi_deg[1];
}

}  // namespace

Region Constraint::whole(int bin_index, const RotationBox& box) const {
  Region r;
  r.bin = bin_index;
  r.hi[kX] = static_cast<std::int16_t>(camera_.width - 1);
  r.hi[kY] = static_cast<std::int16_t>(camera_.height - 1);
  r.lo[kZ] = std::max<std::int16_t>(1, first_at_or_above(min_distance_m_ / kLatticeDistance));
  r.hi[kZ] = last_at_or_below(max_distance_m_ / kLatticeDistance);
  for (std::size_t a = 0; a < 3; ++a) {
    r.lo[kRx + a] = static_cast<std::int16_t>(box.lo_deg[a]);
    r.hi[kRx + a] = static_cast<std::int16_t>(box.hi_deg[a] - 1);
  }
  return r;
}

bool Constraint::contains(const LatticePose& pose) const {
  if (!table_) return true;
  return table_constraint_contains(camera_, table_->table, table_->centre_height_m, table_->tolerance,
                                   pose_of(pose));
}

Region Constraint::tightened(Region region) const {
  if (!table_ || region.empty()) return region;
  const Interval x{static_cast<double>(region.lo[kX]), static_cast<double>(region.hi[kX])};
  const Interval y{static_cast<double>(region.lo[kY]), static_cast<double>(region.hi[kY])};
  const UprightRange upright = upright_range_over(camera_, table_->table.up_in_camera, x, y);
  const Interval z = table_distance_range(table_->table, table_->centre_height_m, table_->tolerance,
                                          upright.sine_of_elevation);
  if (z.empty()) {
    region.hi[kZ] = static_cast<std::int16_t>(region.lo[kZ] - 1);
    return region;
  }
  shrink(region, kZ, z, kLatticeDistance);
  shrink(region, kRy, upright.ry.widened(table_->tolerance.angle_rad), kLatticeAngle);
  const Interval rx = upright.rx.widened(table_->tolerance.angle_rad);
  // Where the range reaches around +-180 deg, an angle and its alias both matter: leave rx alone.
  if (rx.lo > -std::numbers::pi && rx.hi < std::numbers::pi) shrink(region, kRx, rx, kLatticeAngle);
  return region;
}

double Constraint::coverage(const std::vector<ViewpointBin>& bins) const {
  if (!table_) return 1;
  constexpr int kSteps = 16;
  constexpr int kOffsets = 2;
  int feasible = 0;
  int covered = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = (i + 0.5) / kSteps * camera_.width - 0.5;
      const double y = (j + 0.5) / kSteps * camera_.height - 0.5;
      const UprightPose up = upright_pose_at(camera_, table_->table.up_in_camera, x, y);
      const double drop = table_->table.camera_height_m - table_->centre_height_m;
      if (up.sine_of_elevation <= 0) continue;
      const double z = drop / up.sine_of_elevation;
      if (z < min_distance_m_ || z > max_distance_m_) continue;
      for (int a = -kOffsets; a <= kOffsets; ++a) {
        for (int b = -kOffsets; b <= kOffsets; ++b) {
          const double rx_deg = (up.rx + a * table_->tolerance.angle_rad / kOffsets) / kLatticeAngle;
          const double ry_deg = (up.ry + b * table_->tolerance.angle_rad / kOffsets) / kLatticeAngle;
          if (ry_deg < -90) continue;  // over the pole: the same pose has another rx
          ++feasible;
          covered += std::any_of(bins.begin(), bins.end(),
                                 [&](const ViewpointBin& bin) { return box_holds(bin.box, rx_deg, ry_deg); })
                         ? 1
                         : 0;
        }
      }
    }
  }
  return feasible == 0 ? 1 : static_cast<double>(covered) / feasible;
}

}  // namespace sextant
