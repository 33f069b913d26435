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
  if (region_.image) {
    const auto within = [](int value, int limit) {
      return static_cast<std::int16_t>(std::clamp(value, -1, limit));
    };
    r.lo[kX] = std::max(r.lo[kX], within(region_.image->x0, camera_.width));
    r.lo[kY] = std::max(r.lo[kY], within(region_.image->y0, camera_.height));
    r.hi[kX] = std::min(r.hi[kX], within(region_.image->x1, camera_.width));
    r.hi[kY] = std::min(r.hi[kY], within(region_.image->y1, camera_.height));
  }
  r.lo[kZ] = static_cast<std::int16_t>(nearest_index());
  r.hi[kZ] = static_cast<std::int16_t>(farthest_index());
  for (std::size_t a = 0; a < 3; ++a) {
    r.lo[kRx + a] = static_cast<std::int16_t>(first_angle(box.lo_deg[a]));
    r.hi[kRx + a] = static_cast<std::int16_t>(last_angle(box.hi_deg[a]));
  }
  return r;
}

bool Constraint::contains(const LatticePose& pose) const {
  if (region_.image && (pose.at[kX] < region_.image->x0 || pose.at[kX] > region_.image->x1 ||
                        pose.at[kY] < region_.image->y0 || pose.at[kY] > region_.image->y1)) {
    return false;
  }
  if (region_.workspace &&
      !region_.workspace->contains(pose.at[kZ] * kLatticeDistance * camera_.ray(pose.at[kX], pose.at[kY]))) {
    return false;
  }
  if (!table_) return true;
  return table_constraint_contains(camera_, table_->table, table_->centre_height_m, table_->tolerance,
                                   pose_of(pose));
}

Constraint::Steps Constraint::workspace_steps(Interval x, Interval y) const {
  if (!region_.workspace) return {};
  const Interval z = region_.workspace->distances_over(camera_, x, y);
  if (z.empty()) return {1, 0};
  return {first_at_or_above(z.lo / kLatticeDistance), last_at_or_below(z.hi / kLatticeDistance)};
}

Region Constraint::tightened(Region region) const {
  if (region.empty()) return region;
  const Interval x{static_cast<double>(region.lo[kX]), static_cast<double>(region.hi[kX])};
  const Interval y{static_cast<double>(region.lo[kY]), static_cast<double>(region.hi[kY])};
  const Steps steps = workspace_steps(x, y);
  region.lo[kZ] = static_cast<std::int16_t>(std::max<int>(region.lo[kZ], steps.lo));
  region.hi[kZ] = static_cast<std::int16_t>(std::min<int>(region.hi[kZ], steps.hi));
  if (!table_ || region.empty()) return region;
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

double Constraint::nearest_feasible_distance() const {
  if (!table_) return min_distance_m_;
  const UprightRange upright = upright_range_over(camera_, table_->table.up_in_camera,
                                                  {0, camera_.width - 1.0}, {0, camera_.height - 1.0});
  const Interval z = table_distance_range(table_->table, table_->centre_height_m, table_->tolerance,
                                          upright.sine_of_elevation);
  return z.empty() ? max_distance_m_ : std::clamp(z.lo, min_distance_m_, max_distance_m_);
}

int Constraint::nearest_index() const {
  return std::max<std::int16_t>(1, first_at_or_above(min_distance_m_ / kLatticeDistance));
}

int Constraint::farthest_index() const { return last_at_or_below(max_distance_m_ / kLatticeDistance); }

double Constraint::table_distance(int x, int y) const {
  if (!table_) return 0;
  const Eigen::Vector2d t = camera_.tangent(x, y);
  const Eigen::Vector3d ray(t.x(), t.y(), 1);
  const double sine = -table_->table.up_in_camera.dot(ray) / ray.norm();
  const double drop = table_->table.camera_height_m - table_->centre_height_m;
  return sine > 0 ? drop / sine : 0;
}

CellRange Constraint::over_cell(int x0, int y0, int x1, int y1) const {
  CellRange range;
  x1 = std::min(x1, camera_.width - 1);
  y1 = std::min(y1, camera_.height - 1);
  if (x0 > x1 || y0 > y1 || x0 < 0 || y0 < 0) return range;
  if (region_.image) {
    x0 = std::max(x0, region_.image->x0);
    y0 = std::max(y0, region_.image->y0);
    x1 = std::min(x1, region_.image->x1);
    y1 = std::min(y1, region_.image->y1);
    if (x0 > x1 || y0 > y1) return range;
  }
  const Steps steps = workspace_steps({static_cast<double>(x0), static_cast<double>(x1)},
                                      {static_cast<double>(y0), static_cast<double>(y1)});
  const int nearest = std::max(nearest_index(), steps.lo), farthest = std::min(farthest_index(), steps.hi);
  if (nearest > farthest) return range;
  constexpr std::int16_t kAny = 400;  // degrees: wider than every bin
  if (!table_) {
    range.offset_lo = nearest;
    range.offset_hi = farthest;
    range.rx_lo = range.ry_lo = -kAny;
    range.rx_hi = range.ry_hi = kAny;
    return range;
  }
  const UprightRange upright = upright_range_over(camera_, table_->table.up_in_camera,
                                                  {static_cast<double>(x0), static_cast<double>(x1)},
                                                  {static_cast<double>(y0), static_cast<double>(y1)});
  const double drop = table_->table.camera_height_m - table_->centre_height_m;
  const Interval& sine = upright.sine_of_elevation;
  const Interval z = table_distance_range(table_->table, table_->centre_height_m, table_->tolerance, sine);
  if (z.empty() || z.lo > (farthest + 1) * kLatticeDistance || z.hi < (nearest - 1) * kLatticeDistance) {
    return range;
  }
  const double angle = table_->tolerance.angle_rad;
  const Interval ry = upright.ry.widened(angle);
  const Interval rx = upright.rx.widened(angle);
  range.ry_lo = first_at_or_above(ry.lo / kLatticeAngle);
  range.ry_hi = last_at_or_below(ry.hi / kLatticeAngle);
  // Where the range reaches around +-180 deg, an angle and its alias both matter: leave rx alone.
  const bool alias = !(rx.lo > -std::numbers::pi && rx.hi < std::numbers::pi);
  range.rx_lo = alias ? static_cast<std::int16_t>(-kAny) : first_at_or_above(rx.lo / kLatticeAngle);
  range.rx_hi = alias ? kAny : last_at_or_below(rx.hi / kLatticeAngle);
  if (sine.lo <= 0 || drop / sine.lo > 30000 * kLatticeDistance) {  // at the horizon: distances without end
    range.table_distance = {std::min(drop, 0.0) / sine.hi, 1e6};
    range.offset_lo = -32000;
    range.offset_hi = 32000;
    return range;
  }
  range.table_distance =
      Interval{std::min(drop / sine.hi, drop / sine.lo), std::max(drop / sine.hi, drop / sine.lo)}.widened(
          1e-9);
  // |drop - z sine| <= height tolerance; one step for the floor of the anchor, one for the rounding.
  const double spread = table_->tolerance.height_m / sine.lo / kLatticeDistance;
  range.offset_lo = static_cast<int>(std::floor(-spread)) - 1;
  range.offset_hi = static_cast<int>(std::ceil(spread)) + 2;
  return range;
}

double Constraint::coverage(const std::vector<ViewpointBin>& bins) const {
  if (!table_) return 1;
  constexpr int kSteps = 16;
  constexpr int kOffsets = 2;
  // Bins of all turns share their tilts.
  std::vector<RotationBox> tilts;
  for (const ViewpointBin& bin : bins) {
    const auto same = [&](const RotationBox& other) {
      return other.lo_deg[0] == bin.box.lo_deg[0] && other.hi_deg[0] == bin.box.hi_deg[0] &&
             other.lo_deg[1] == bin.box.lo_deg[1] && other.hi_deg[1] == bin.box.hi_deg[1];
    };
    if (std::none_of(tilts.begin(), tilts.end(), same)) tilts.push_back(bin.box);
  }
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
          const double rx_deg = (up.rx + a * table_->tolerance.angle_rad / kOffsets) / kOneDegree;
          const double ry_deg = (up.ry + b * table_->tolerance.angle_rad / kOffsets) / kOneDegree;
          if (ry_deg < -90) continue;  // over the pole: the same pose has another rx
          ++feasible;
          covered += std::any_of(tilts.begin(), tilts.end(),
                                 [&](const RotationBox& tilt) { return box_holds(tilt, rx_deg, ry_deg); })
                         ? 1
                         : 0;
        }
      }
    }
  }
  return feasible == 0 ? 1 : static_cast<double>(covered) / feasible;
}

}  // namespace sextant
