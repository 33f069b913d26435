// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/bin_layout.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "runtime/base/error.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSamplingSlack = 0.75;  ///< degrees; covers what lies between the samples below

/// First edge of the grid `origin + k * width` at or below value.
int cell(double value_deg, int origin, int width) {
  return origin + width * static_cast<int>(std::floor((value_deg - origin) / width));
}

using Cell = std::pair<int, int>;  ///< lower edges of rx, ry

/// Cells that an upright object at one pixel can fall into.
void add_cells(const LearnParameters& p, const UprightPose& upright, std::set<Cell>& cells) {
  const double reach = p.angle_tolerance_deg + kSamplingSlack;
  const int rx_origin = -p.bin_width_deg / 2;
  const double rx = upright.rx / kDegree;
  const double ry = upright.ry / kDegree;
  for (int a = cell(rx - reach, rx_origin, p.bin_width_deg); a <= rx + reach; a += p.bin_width_deg) {
    for (int b = cell(std::max(ry - reach, -90.0), -90, p.bin_width_deg); b <= std::min(ry + reach, 90.0);
         b += p.bin_width_deg) {
      if (a + p.bin_width_deg > -180 && a < 180) cells.insert({a, b});
    }
  }
}

/// Cells of every orientation. Towards ry = -90 and 90 deg, where rx and rz turn about the same axis, several
/// of them hold the same orientations: that costs time and loses nothing.
std::set<Cell> all_cells(const LearnParameters& p) {
  std::set<Cell> cells;
  for (int rx = cell(-180, -p.bin_width_deg / 2, p.bin_width_deg); rx < 180; rx += p.bin_width_deg) {
    for (int ry = -90; ry < 90; ry += p.bin_width_deg) cells.insert({rx, ry});
  }
  return cells;
}

/// Cells that objects standing upright before the declared cameras can fall into.
std::set<Cell> upright_cells(const LearnParameters& p) {
  constexpr int kPixels = 48;  // samples per image side
  constexpr double kStep = 1;  // degrees of pitch and roll
  std::set<Cell> cells;
  const auto steps = [](double lo, double hi) {
    return std::max(1, static_cast<int>(std::ceil((hi - lo) / kStep)));
  };
  const int pitches = steps(p.min_pitch_deg, p.max_pitch_deg);
  const int rolls = steps(-p.max_roll_deg, p.max_roll_deg);
  for (int i = 0; i <= pitches; ++i) {
    const double pitch = p.min_pitch_deg + (p.max_pitch_deg - p.min_pitch_deg) * i / pitches;
    for (int j = 0; j <= rolls; ++j) {
      const double roll = p.max_roll_deg * (2.0 * j / rolls - 1);
      const auto table = TableGeometry::from_pitch_roll(pitch * kDegree, roll * kDegree, 1);
      for (int u = 0; u <= kPixels; ++u) {
        for (int v = 0; v <= kPixels; ++v) {
          const UprightPose upright =
              upright_pose_at(p.camera, table.up_in_camera, u * (p.camera.width - 1.0) / kPixels,
                              v * (p.camera.height - 1.0) / kPixels);
          if (upright.sine_of_elevation > 0) add_cells(p, upright, cells);
        }
      }
    }
  }
  return cells;
}

}  // namespace

std::vector<RotationBox> lay_out_bins(const LearnParameters& p, int symmetry_deg) {
  if (symmetry_deg != 0 && symmetry_deg != 90 && symmetry_deg != 180 && symmetry_deg != 360) {
    throw UsageError("the symmetry angle must be 0, 90, 180 or 360 degrees");
  }
  const std::set<Cell> cells = p.all_orientations != 0 ? all_cells(p) : upright_cells(p);
  const int rz_bins = symmetry_deg == 0 ? 1 : (symmetry_deg + p.turn_width_deg - 1) / p.turn_width_deg;
  std::vector<RotationBox> boxes;
  for (const auto& [rx, ry] : cells) {
    for (int k = 0; k < rz_bins; ++k) {
      RotationBox box;
      const int rx_lo = std::max(rx, -180);
      box.lo_deg = {rx_lo, ry, symmetry_deg * k / rz_bins};
      const bool to_the_pole = p.all_orientations != 0 && ry + p.bin_width_deg >= 90;
      box.hi_deg = {std::min(rx + p.bin_width_deg, 180),
                    to_the_pole ? 91 : std::min(ry + p.bin_width_deg, 91),
                    symmetry_deg == 0 ? 1 : symmetry_deg * (k + 1) / rz_bins};
      boxes.push_back(box);
    }
  }
  return boxes;
}

}  // namespace sextant
