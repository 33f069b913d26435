// SPDX-License-Identifier: Apache-2.0
// Closed intervals of doubles, for conservative ranges. Results are exact up to rounding; whoever needs a
// proof widens them (`widened`).
#pragma once

#include <algorithm>

namespace sextant {

struct Interval {
  double lo = 0;
  double hi = 0;

  bool empty() const { return lo > hi; }
  bool contains(double v) const { return lo <= v && v <= hi; }
  Interval widened(double by) const { return {lo - by, hi + by}; }
};

inline Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
inline Interval operator-(Interval a, Interval b) { return {a.lo - b.hi, a.hi - b.lo}; }
inline Interval operator*(double s, Interval a) {
  return s >= 0 ? Interval{s * a.lo, s * a.hi} : Interval{s * a.hi, s * a.lo};
}
inline Interval operator*(Interval a, Interval b) {
  const double p[] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
  return {*std::min_element(p, p + 4), *std::max_element(p, p + 4)};
}
inline Interval operator+(double s, Interval a) { return {s + a.lo, s + a.hi}; }
/// The square, tighter than a * a where a spans 0.
inline Interval square(Interval a) {
  const double l = a.lo * a.lo;
  const double h = a.hi * a.hi;
  return {a.contains(0) ? 0 : std::min(l, h), std::max(l, h)};
}
inline Interval intersect(Interval a, Interval b) { return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)}; }
inline Interval hull(Interval a, Interval b) { return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)}; }

}  // namespace sextant
