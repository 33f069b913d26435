// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/camera_measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>

#include "runtime/base/error.h"
#include "runtime/frame/table_fit.h"

namespace sextant {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kNoiseStep = 8;    ///< pixels between samples of temporal noise
constexpr int kFewestLooks = 5;  ///< frames that a pixel must be seen in
constexpr double kOldMs = 100;   ///< live frames older than this are never searched

std::string spread_text(const Spread& s, double unit, int digits) {
  return fmt::format("{:.{}f} ({:.{}f} to {:.{}f})", s.median * unit, digits, s.lowest * unit, digits,
                     s.highest * unit, digits);
}

Finding judged(const char* check, bool good, std::string what, std::string advice,
               FindingState otherwise = FindingState::kWarning) {
  return {good ? FindingState::kGood : otherwise, check, std::move(what), good ? "" : std::move(advice)};
}

/// The frame's plane, of its estimate.
bool is_on_table(const TableGeometry& table, const Eigen::Vector3d& p) {
  return lies_on({table.up_in_camera, table.camera_height_m}, p, 2);
}

}  // namespace

Spread Spread::of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}

void CameraMeasurement::add(const RgbdFrame& frame, MonotonicTime now) {
  using Ms = std::chrono::duration<double, std::milli>;
  if (frames_ > 0) {
    intervals_ms_.push_back(Ms(frame.captured_monotonic - last_.captured_monotonic).count());
  }
  ages_ms_.push_back(Ms(now - frame.captured_monotonic).count());
  ++frames_;
  last_ = frame;
  measure_noise(frame);

  const TablePoints points = table_points(frame);
  const auto estimate = estimate_table(points);
  last_estimate_ = estimate ? std::optional(*estimate) : std::nullopt;
  const auto missing = std::count_if(points.points.begin(), points.points.end(),
                                     [](const Eigen::Vector3f& p) { return p.z() <= 0; });
  holes_.push_back(static_cast<double>(missing) / static_cast<double>(points.points.size()));
  if (!estimate) {
    ++refused_;
    last_refusal_ = estimate.error().reason;
    return;
  }
  residuals_m_.push_back(estimate->residual_m);
  heights_m_.push_back(estimate->table.camera_height_m);
  pitches_rad_.push_back(estimate->table.pitch_rad());
  rolls_rad_.push_back(estimate->table.roll_rad());
  if (frame.table) {
    height_errors_m_.push_back(estimate->table.camera_height_m - frame.table->camera_height_m);
    tilt_errors_rad_.push_back(
        std::atan2(estimate->table.up_in_camera.cross(frame.table->up_in_camera).norm(),
                   estimate->table.up_in_camera.dot(frame.table->up_in_camera)));
  }
  // Holes among table: missing samples whose neighbours to both sides are on the table.
  int on_table = 0;
  int holes = 0;
  for (int y = 0; y < points.rows; ++y) {
    for (int x = 1; x + 1 < points.columns; ++x) {
      const auto on = [&](int column) {
        const Eigen::Vector3f& p = points.at(column, y);
        return p.z() > 0 && is_on_table(estimate->table, p.cast<double>());
      };
      if (on(x)) {
        ++on_table;
      } else if (points.at(x, y).z() <= 0 && on(x - 1) && on(x + 1)) {
        ++holes;
      }
    }
  }
  if (on_table > 0) holes_on_table_.push_back(static_cast<double>(holes) / (on_table + holes));
  last_.table = estimate->table;
  last_.table_uncertainty = estimate->uncertainty;
}

void CameraMeasurement::measure_noise(const RgbdFrame& frame) {
  const cv::Mat& depth = frame.axial_depth_m;
  const std::size_t samples = static_cast<std::size_t>((depth.rows + kNoiseStep - 1) / kNoiseStep) *
                              static_cast<std::size_t>((depth.cols + kNoiseStep - 1) / kNoiseStep);
  if (counts_.size() != samples) {
    sum_.assign(samples, 0);
    squares_.assign(samples, 0);
    counts_.assign(samples, 0);
  }
  std::size_t i = 0;
  for (int y = 0; y < depth.rows; y += kNoiseStep) {
    for (int x = 0; x < depth.cols; x += kNoiseStep, ++i) {
      const float z = depth.at<float>(y, x);
      if (!(z > 0)) continue;
      // Millimetres about one metre, so that floats suffice.
      const float mm = (z - 1) * 1000;
      sum_[i] += mm;
      squares_[i] += mm * mm;
      ++counts_[i];
    }
  }
}

std::optional<Spread> CameraMeasurement::temporal_noise_m() const {
  std::vector<double> deviations;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] < kFewestLooks) continue;
    const double mean = sum_[i] / static_cast<float>(counts_[i]);
    const double variance = squares_[i] / static_cast<float>(counts_[i]) - mean * mean;
    deviations.push_back(1e-3 * std::sqrt(std::max(0.0, variance)));
  }
  if (deviations.size() < 50) return std::nullopt;
  return Spread::of(std::move(deviations));
}

std::vector<Finding> CameraMeasurement::findings(const SourceStatistics& source) const {
  std::vector<Finding> out;
  if (frames_ == 0) {
    out.push_back({FindingState::kBad, "frames", "none came", "look at the source's state above"});
    return out;
  }
  if (live_ && intervals_ms_.size() >= 3) {
    const Spread interval = Spread::of(intervals_ms_);
    const double rate =
        1000 / std::max(1e-3, std::accumulate(intervals_ms_.begin(), intervals_ms_.end(), 0.0) /
                                  static_cast<double>(intervals_ms_.size()));
    double jitter = 0;
    for (const double i : intervals_ms_) jitter += std::abs(i - interval.median);
    jitter /= static_cast<double>(intervals_ms_.size());
    out.push_back(judged("rate", rate > 4,
                         fmt::format("{:.1f} Hz, intervals {} ms, mean jitter {:.1f} ms", rate,
                                     spread_text(interval, 1, 1), jitter),
                         "more light or a fixed exposure; another USB port or a smaller size"));
    const Spread age = Spread::of(ages_ms_);
    out.push_back(judged("age", age.highest < kOldMs,
                         fmt::format("{} ms when handed out", spread_text(age, 1, 1)),
                         "frames older than 100 ms are never searched: look for a slow driver or network"));
  }
  const std::uint64_t dropped = source.dropped();
  out.push_back(
      judged("losses", dropped * 50 <= source.delivered + dropped,
             fmt::format("{} delivered, {} dropped: {}", source.delivered, dropped, describe_drops(source)),
             "lost: USB or network; unpaired: clocks or rates of the two streams; stale: a slow path"));
  const Spread holes = Spread::of(holes_);
  out.push_back(judged("depth", holes.median < 0.4,
                       fmt::format("{} % of the image missing", spread_text(holes, 100, 0)),
                       "nearer or farther, less sunlight, fewer mirrors and glass"));
  if (!holes_on_table_.empty()) {
    const Spread on_table = Spread::of(holes_on_table_);
    out.push_back(judged("table holes", on_table.median < 0.05,
                         fmt::format("{} % of the table missing", spread_text(on_table, 100, 1)),
                         "a matt table cloth; another angle"));
  }
  if (const auto noise = temporal_noise_m(); noise && live_) {
    out.push_back(
        judged("depth noise", noise->median < 0.004,
               fmt::format("{:.1f} mm from frame to frame (median of the image)", noise->median * 1e3),
               "hold the camera still while measuring; look at exposure and projector"));
  }
  if (heights_m_.empty()) {
    out.push_back({FindingState::kBad, "table", "refused in every frame: " + last_refusal_, ""});
    return out;
  }
  out.push_back(judged(
      "table flatness", Spread::of(residuals_m_).median < 0.004,
      fmt::format("{} mm off the plane (root mean square)", spread_text(Spread::of(residuals_m_), 1e3, 1)),
      "calibrate the depth camera: its plane is warped"));
  const TableUncertainty& u = last_estimate_ ? last_estimate_->uncertainty : TableUncertainty{};
  out.push_back(
      judged("table", refused_ == 0,
             fmt::format("height {} m, pitch {} deg, roll {} deg; deviations {:.1f} mm, {:.2f} deg; {} of {} "
                         "frames refused",
                         spread_text(Spread::of(heights_m_), 1, 3),
                         spread_text(Spread::of(pitches_rad_), kDegrees, 1),
                         spread_text(Spread::of(rolls_rad_), kDegrees, 1), u.height_m * 1e3,
                         u.tilt_rad * kDegrees, refused_, frames_),
             last_refusal_));
  if (!height_errors_m_.empty()) {
    std::vector<double> absolute = height_errors_m_;
    for (double& e : absolute) e = std::abs(e);
    out.push_back({FindingState::kNote, "against the set",
                   fmt::format("{} frames: height off by {} mm, normal by {} deg", height_errors_m_.size(),
                               spread_text(Spread::of(absolute), 1e3, 1),
                               spread_text(Spread::of(tilt_errors_rad_), kDegrees, 2)),
                   ""});
  }
  return out;
}

nlohmann::ordered_json CameraMeasurement::json(const SourceStatistics& source) const {
  const auto spread = [](const std::vector<double>& values, double unit) -> nlohmann::ordered_json {
    if (values.empty()) return nullptr;
    const Spread s = Spread::of(values);
    return {{"median", s.median * unit}, {"lowest", s.lowest * unit}, {"highest", s.highest * unit}};
  };
  nlohmann::ordered_json drops = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < kDropReasons; ++i) {
    if (source.drops[i] > 0) drops[name_of(static_cast<DropReason>(i))] = source.drops[i];
  }
  const auto noise = temporal_noise_m();
  return {{"frames", frames_},
          {"refused", refused_},
          {"drops", drops},
          {"interval_ms", live_ ? spread(intervals_ms_, 1) : nullptr},
          {"age_ms", live_ ? spread(ages_ms_, 1) : nullptr},
          {"depth_missing_share", spread(holes_, 1)},
          {"table_missing_share", spread(holes_on_table_, 1)},
          {"depth_noise_m", noise && live_ ? nlohmann::ordered_json(noise->median) : nullptr},
          {"table_residual_m", spread(residuals_m_, 1)},
          {"height_m", spread(heights_m_, 1)},
          {"pitch_rad", spread(pitches_rad_, 1)},
          {"roll_rad", spread(rolls_rad_, 1)},
          {"height_error_m", spread(height_errors_m_, 1)},
          {"tilt_error_rad", spread(tilt_errors_rad_, 1)},
          {"findings", findings_json(findings(source))}};
}

}  // namespace sextant
