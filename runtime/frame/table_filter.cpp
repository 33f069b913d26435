// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

double seconds_between(TableFilter::Time from, TableFilter::Time to) {
  return std::chrono::duration<double>(to - from).count();
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double square(double v) { return v * v; }

/// One-dimensional Kalman update: the share of the new value, and the deviation afterwards, which stays above
/// half of the new value's own.
struct Blend {
  double gain;
  double deviation;
  Blend(double old_deviation, double new_deviation) {
    const double a = square(old_deviation);
    const double b = square(new_deviation);
    gain = a / std::max(a + b, 1e-30);
    deviation = std::max(std::sqrt(a * (1 - gain)), 0.5 * new_deviation);
  }
};

}  // namespace

bool TableFilter::agrees(const KnownTable& a, const KnownTable& b, double seconds) const {
  const double tilt = std::sqrt(square(a.uncertainty.tilt_rad) + square(b.uncertainty.tilt_rad)) +
                      options_.drift_rad_per_s * seconds;
  const double height = std::sqrt(square(a.uncertainty.height_m) + square(b.uncertainty.height_m)) +
                        options_.drift_m_per_s * seconds;
  return angle_between(a.table.up_in_camera, b.table.up_in_camera) <= options_.gate * tilt &&
         std::abs(a.table.camera_height_m - b.table.camera_height_m) <= options_.gate * height;
}

void TableFilter::restart(const KnownTable& estimate, Time at) {
  state_ = estimate;
  updated_ = at;
  outlier_.reset();
  outliers_ = 0;
}

bool TableFilter::update(const KnownTable& estimate, Time at) {
  const double seconds = state_ ? seconds_between(updated_, at) : 0;
  if (!state_ || seconds < 0 || seconds > options_.max_age_s) {
    restart(estimate, at);
    return true;
  }
  if (!agrees(*state_, estimate, seconds)) {
    const bool again = outlier_ && agrees(*outlier_, estimate, 0);
    outliers_ = again ? outliers_ + 1 : 1;
    outlier_ = estimate;
    if (outliers_ < options_.outliers_to_restart) return false;
    restart(estimate, at);
    ++restarts_;
    return true;
  }
  outlier_.reset();
  outliers_ = 0;
  TableUncertainty& u = state_->uncertainty;
  const TableUncertainty& e = estimate.uncertainty;
  const Blend tilt(std::hypot(u.tilt_rad, options_.drift_rad_per_s * seconds), e.tilt_rad);
  const Blend height(std::hypot(u.height_m, options_.drift_m_per_s * seconds), e.height_m);
  TableGeometry& t = state_->table;
  t.up_in_camera = (t.up_in_camera + tilt.gain * (estimate.table.up_in_camera - t.up_in_camera)).normalized();
  t.camera_height_m += height.gain * (estimate.table.camera_height_m - t.camera_height_m);
  // What follows from tilt and height shrinks as they do.
  u.pitch_rad = e.pitch_rad * tilt.deviation / e.tilt_rad;
  u.roll_rad = e.roll_rad * tilt.deviation / e.tilt_rad;
  u.surface_m = e.surface_m * std::max(height.deviation / e.height_m, tilt.deviation / e.tilt_rad);
  u.tilt_rad = tilt.deviation;
  u.height_m = height.deviation;
  updated_ = at;
  return true;
}

std::optional<KnownTable> TableFilter::at(Time time) const {
  if (!state_) return std::nullopt;
  const double seconds = seconds_between(updated_, time);
  if (seconds > options_.max_age_s || seconds < -options_.max_age_s) return std::nullopt;
  KnownTable now = *state_;
  const double idle = std::max(0.0, seconds);
  TableUncertainty& u = now.uncertainty;
  const double turn = options_.drift_rad_per_s * idle;
  const double shift = options_.drift_m_per_s * idle;
  for (double* angle : {&u.pitch_rad, &u.roll_rad, &u.tilt_rad}) *angle = std::hypot(*angle, turn);
  u.height_m = std::hypot(u.height_m, shift);
  u.surface_m = std::hypot(u.surface_m, shift);
  return now;
}

}  // namespace sextant
