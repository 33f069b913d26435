// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same on every machine: the standard fixes the engine but not the distributions.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace sextant {

/// Scrambles a seed and a stream number into an independent seed (splitmix64's finaliser).
inline std::uint64_t derived_seed(std::uint64_t seed, std::uint64_t stream) {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ULL * (stream + 1);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

/// A closed range.
struct Range {
  double lo = 0;
  double hi = 0;
};

/// Note: the order in which C++ evaluates function arguments is open. Draw one number per statement or in
/// braces.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [lo, hi).
  double uniform(double lo = 0, double hi = 1) {
    return lo + (hi - lo) * (static_cast<double>(engine_() >> 11) * 0x1.0p-53);
  }
  double in(const Range& range) { return uniform(range.lo, range.hi); }
  /// In [lo, hi], whole.
  int integer(int lo, int hi) { return lo + static_cast<int>(uniform() * (hi - lo + 1)); }
  bool chance(double probability) { return uniform() < probability; }
  /// Standard normal (Box-Muller).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    return radius * std::cos(angle);
  }
  std::uint64_t bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace sextant
