// SPDX-License-Identifier: Apache-2.0
// The lattice of poses over which "the global optimum" is claimed: 1 px, 1 px, 4 mm,
// 2 deg, 2 deg, 2 deg (refinement does what is finer), anchored at 0 for every frame and bin, never
// re-anchored by clipping. Regions are boxes of lattice poses of one viewpoint bin.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <numbers>

#include "runtime/geometry/pose6.h"

namespace sextant {

inline constexpr double kLatticeDistance = 0.004;  ///< metres per step of z
inline constexpr int kLatticeDegrees = 2;          ///< degrees per step of rx, ry, rz
inline constexpr double kOneDegree = std::numbers::pi / 180.0;
inline constexpr double kLatticeAngle = kLatticeDegrees * kOneDegree;  ///< radians per step of rx, ry, rz

/// Lattice angles in [lo_deg, hi_deg), whole degrees: first_angle(lo_deg) .. last_angle(hi_deg).
constexpr int first_angle(int lo_deg) {
  return lo_deg >= 0 ? (lo_deg + kLatticeDegrees - 1) / kLatticeDegrees : -(-lo_deg / kLatticeDegrees);
}
constexpr int last_angle(int hi_deg) { return first_angle(hi_deg) - 1; }

/// Dimensions of a pose, in the order of the total order that breaks ties.
enum Dimension : std::uint8_t { kX = 0, kY, kZ, kRx, kRy, kRz, kDimensions };

/// One pose of the lattice in one bin. The comparison is the fixed total order (bin, x, y, z, rx, ry, rz).
struct LatticePose {
  std::int32_t bin = 0;
  std::array<std::int16_t, kDimensions> at{};

  auto operator<=>(const LatticePose&) const = default;
};

/// Coordinates as the score sees them: single precision, monotone in the lattice index.
inline float lattice_pixel(int index) { return static_cast<float>(index); }
inline float lattice_distance(int index) { return static_cast<float>(index * kLatticeDistance); }
inline float lattice_angle(int index) { return static_cast<float>(index * kLatticeAngle); }

/// The pose in pixels, metres, radians.
inline Pose6 pose_of(const LatticePose& p) {
  return {static_cast<double>(p.at[kX]), static_cast<double>(p.at[kY]), p.at[kZ] * kLatticeDistance,
          p.at[kRx] * kLatticeAngle,     p.at[kRy] * kLatticeAngle,     p.at[kRz] * kLatticeAngle};
}

/// A box of lattice poses of one bin: lo <= index <= hi in every dimension (closed, unlike the thesis's real
/// intervals: integers need no half-open ends).
struct Region {
  std::int32_t bin = 0;
  std::array<std::int16_t, kDimensions> lo{};
  std::array<std::int16_t, kDimensions> hi{};

  bool empty() const {
    for (std::size_t d = 0; d < kDimensions; ++d) {
      if (lo[d] > hi[d]) return true;
    }
    return false;
  }
  bool single() const { return lo == hi; }
  bool contains(const LatticePose& p) const {
    if (p.bin != bin) return false;
    for (std::size_t d = 0; d < kDimensions; ++d) {
      if (p.at[d] < lo[d] || p.at[d] > hi[d]) return false;
    }
    return true;
  }
  LatticePose first() const { return {bin, lo}; }
  double volume() const {
    double v = 1;
    for (std::size_t d = 0; d < kDimensions; ++d) v *= hi[d] - lo[d] + 1;
    return v;
  }
  bool operator==(const Region&) const = default;
};

}  // namespace sextant
