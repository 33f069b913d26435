// SPDX-License-Identifier: Apache-2.0
// The table over time: estimates of single frames averaged while the camera stands, followed while it moves
// slowly, begun again when it has moved; one bad frame changes nothing.
#pragma once

#include <chrono>
#include <optional>

#include "runtime/geometry/table_geometry.h"

namespace sextant {

struct TableFilterOptions {
  double drift_rad_per_s = 0.002;  ///< how fast the direction may change, one deviation after a second
  double drift_m_per_s = 0.001;    ///< how fast the height may change
  double gate = 4;                 ///< deviations beyond which an estimate is an outlier
  int outliers_to_restart = 3;     ///< that many in a row, agreeing with each other: the camera has moved
  double max_age_s = 2;            ///< without an accepted estimate for so long, there is no table
};

/// A table with its uncertainty.
struct KnownTable {
  TableGeometry table;
  TableUncertainty uncertainty;
};

/// Not thread-safe. Times may be of any steady clock, and must not run backwards (a smaller one restarts).
class TableFilter {
 public:
  using Time = std::chrono::nanoseconds;

  explicit TableFilter(TableFilterOptions options = {}) : options_(options) {}

  /// Takes an estimate. False: it was an outlier and changed nothing.
  bool update(const KnownTable& estimate, Time at);
  /// The table at that time; nothing before the first estimate and max_age_s after the last accepted one.
  /// The uncertainty never falls below half of a single estimate's: neighbouring frames share their errors.
  std::optional<KnownTable> at(Time time) const;
  /// How often it began again because the camera had moved.
  int restarts() const { return restarts_; }

 private:
  void restart(const KnownTable& estimate, Time at);
  bool agrees(const KnownTable& a, const KnownTable& b, double seconds) const;

  TableFilterOptions options_;
  std::optional<KnownTable> state_;  ///< uncertainty: height_m, surface_m and tilt_rad are filtered
  Time updated_{};
  std::optional<KnownTable> outlier_;
  int outliers_ = 0;
  int restarts_ = 0;
};

}  // namespace sextant
