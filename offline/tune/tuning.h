// SPDX-License-Identifier: Apache-2.0
// A tuning run: every point is tried on the training half, the best one and the defaults are then held
// against the other half. Each trial's answer is a file, so that a run that was stopped goes on where it was,
// and several processes (MPI ranks) may share the work through one folder.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "offline/tune/sweep.h"

namespace sextant {

enum class Half { kTraining, kHeldOut };
const char* to_string(Half half);

/// How good a point is on one half of the images.
struct TrialScore {
  int images = 0;
  int instances = 0;
  double average_precision = 0;
  double share_right = 0;   ///< within 1 cm and 15 deg
  double share_strict = 0;  ///< within 5 mm and 5 deg
  double seconds = 0;       ///< per image
};

/// "ap", "right" or "strict". Throws UsageError.
double metric_of(const TrialScore& score, const std::string& metric);

/// Tries a point on a half.
using Trial = std::function<TrialScore(const TunePoint& point, Half half)>;

struct TuneRun {
  std::vector<Sweep> sweeps;
  bool grid = false;
  std::string metric = "ap";
  std::filesystem::path folder;  ///< the trials' files go into folder/trials
  std::string identity;          ///< all that the answers depend on beside the point (mesh, data set, base)
  std::size_t first = 0;         ///< this process takes points first, first + stride, ..
  std::size_t stride = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;
};

struct TuneResult {
  std::vector<TunePoint> points;     ///< defaults first; the combination of the single best values last
  std::vector<TrialScore> training;  ///< per point
  std::size_t best = 0;              ///< index into points, by the metric on the training half
  TrialScore held_out_defaults, held_out_best;
};

/// Tries this process's share of the points on the training half.
void run_share(const TuneRun& run, const Trial& trial);
/// Tries what is missing (all that run_share left out), chooses, and reports on the held-out half. A later
/// point must beat the earlier ones by more than 1e-9: ties keep the defaults. After single sweeps the
/// combination of the values that beat the defaults, each alone, is tried as well.
TuneResult finish_run(const TuneRun& run, const Trial& trial);

/// The file of a trial's answer; its name depends on identity, point and half alone.
std::filesystem::path trial_file(const TuneRun& run, const TunePoint& point, Half half);

}  // namespace sextant
