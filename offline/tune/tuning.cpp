// SPDX-License-Identifier: Apache-2.0
#include "offline/tune/tuning.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hal/image/file_bytes.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxTrialBytes = 1 << 20;

std::string key_of(const TuneRun& run, const TunePoint& point, Half half) {
  return run.identity + "\n" + describe(point) + "\n" + to_string(half);
}

/// The answer in a file, where it is there and is this trial's.
std::optional<TrialScore> stored(const std::filesystem::path& file, const std::string& key) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  const std::vector<std::byte> bytes = read_file_bytes(file, kMaxTrialBytes);
  const Json json = Json::parse(reinterpret_cast<const char*>(bytes.data()),
                                reinterpret_cast<const char*>(bytes.data()) + bytes.size(), nullptr, false);
  // A damaged or foreign file is tried again rather than believed.
  if (!json.is_object() || !json.contains("key") || json["key"] != key) return std::nullopt;
  TrialScore score;
  try {
    score.images = json.at("images");
    score.instances = json.at("instances");
    score.average_precision = json.at("average_precision");
    score.share_right = json.at("share_right");
    score.share_strict = json.at("share_strict");
    score.seconds = json.at("seconds");
  } catch (const Json::exception&) {
    return std::nullopt;
  }
  return score;
}

TrialScore tried(const TuneRun& run, const Trial& trial, const TunePoint& point, Half half) {
  const std::filesystem::path file = trial_file(run, point, half);
  const std::string key = key_of(run, point, half);
  if (const auto known = stored(file, key)) return *known;
  const TrialScore score = trial(point, half);
  std::error_code error;
  std::filesystem::create_directories(file.parent_path(), error);
  if (error)
    throw InputError(file.parent_path().string(), "this folder cannot be made (" + error.message() + ")");
  const std::string text = Json{{"key", key},
                                {"images", score.images},
                                {"instances", score.instances},
                                {"average_precision", score.average_precision},
                                {"share_right", score.share_right},
                                {"share_strict", score.share_strict},
                                {"seconds", score.seconds}}
                               .dump(1) +
                           "\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
  return score;
}

/// Every parameter's best value, where it beats the defaults.
TunePoint combination(const TuneRun& run, const TuneResult& result) {
  TunePoint point;
  const double defaults = metric_of(result.training[0], run.metric);
  std::map<std::string, double> best;
  for (std::size_t i = 1; i < result.points.size(); ++i) {
    const auto& [name, value] = *result.points[i].begin();
    const double m = metric_of(result.training[i], run.metric);
    const auto known = best.find(name);
    if (m > (known == best.end() ? defaults : known->second) + 1e-9) {
      best[name] = m;
      point[name] = value;
    }
  }
  return point;
}

}  // namespace

const char* to_string(Half half) { return half == Half::kTraining ? "training" : "held-out"; }

double metric_of(const TrialScore& score, const std::string& metric) {
  if (metric == "ap") return score.average_precision;
  if (metric == "right") return score.share_right;
  if (metric == "strict") return score.share_strict;
  throw UsageError("there is no metric \"" + metric + "\"", "choose ap, right or strict");
}

std::filesystem::path trial_file(const TuneRun& run, const TunePoint& point, Half half) {
  const std::string key = key_of(run, point, half);
  return run.folder / "trials" / fmt::format("{:016x}.json", XXH3_64bits(key.data(), key.size()));
}

void run_share(const TuneRun& run, const Trial& trial) {
  const std::vector<TunePoint> points = points_of(run.sweeps, run.grid);
  for (std::size_t i = run.first; i < points.size(); i += run.stride) {
    tried(run, trial, points[i], Half::kTraining);
    if (run.progress) run.progress(i + 1, points.size());
  }
}

TuneResult finish_run(const TuneRun& run, const Trial& trial) {
  TuneResult result;
  result.points = points_of(run.sweeps, run.grid);
  metric_of({}, run.metric);  // a wrong name is refused before the work
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    result.training.push_back(tried(run, trial, result.points[i], Half::kTraining));
    if (run.progress) run.progress(i + 1, result.points.size());
  }
  if (!run.grid) {
    const TunePoint together = combination(run, result);
    if (together.size() > 1) {
      result.points.push_back(together);
      result.training.push_back(tried(run, trial, together, Half::kTraining));
    }
  }
  for (std::size_t i = 1; i < result.points.size(); ++i) {
    if (metric_of(result.training[i], run.metric) >
        metric_of(result.training[result.best], run.metric) + 1e-9)
      result.best = i;
  }
  result.held_out_defaults = tried(run, trial, {}, Half::kHeldOut);
  result.held_out_best = tried(run, trial, result.points[result.best], Half::kHeldOut);
  return result;
}

}  // namespace sextant
