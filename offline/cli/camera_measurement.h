// SPDX-License-Identifier: Apache-2.0
// What a camera really does, measured from its frames: rate and jitter, age, depth noise and holes, the table
// estimate and how steady it is. Judged into findings with advice.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "hal/source_status.h"
#include "offline/cli/finding.h"
#include "runtime/frame/rgbd_frame.h"
#include "runtime/frame/table_estimate.h"

namespace sextant {

/// Median and extremes of a quantity.
struct Spread {
  double median = 0;
  double lowest = 0;
  double highest = 0;
  static Spread of(std::vector<double> values);
};

class CameraMeasurement {
 public:
  /// live: ages and the rate mean something (a playback as fast as possible has none).
  explicit CameraMeasurement(bool live) : live_(live) {}

  /// Takes a frame that was handed out at `now`.
  void add(const RgbdFrame& frame, MonotonicTime now);

  std::vector<Finding> findings(const SourceStatistics& source) const;
  nlohmann::ordered_json json(const SourceStatistics& source) const;
  int frames() const { return frames_; }
  /// The last frame, with its estimated table where there is one.
  const RgbdFrame& last() const { return last_; }
  const std::optional<TableEstimate>& last_estimate() const { return last_estimate_; }

 private:
  void measure_noise(const RgbdFrame& frame);
  std::optional<Spread> temporal_noise_m() const;

  bool live_;
  int frames_ = 0;
  RgbdFrame last_;
  std::optional<TableEstimate> last_estimate_;
  std::string last_refusal_;
  int refused_ = 0;
  std::vector<double> intervals_ms_, ages_ms_;
  std::vector<double> holes_, holes_on_table_, residuals_m_;  ///< shares, shares, metres
  std::vector<double> heights_m_, pitches_rad_, rolls_rad_;
  std::vector<double> height_errors_m_, tilt_errors_rad_;  ///< against the source's own table
  std::vector<float> sum_, squares_;                       ///< of depth, per sampled pixel
  std::vector<int> counts_;
};

}  // namespace sextant
