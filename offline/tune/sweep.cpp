// SPDX-License-Identifier: Apache-2.0
#include "offline/tune/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numbers>
#include <set>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxPoints = 10'000;

double number(const std::string& name, const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw UsageError(fmt::format("{} = \"{}\" is no number", name, text));
  return value;
}

std::vector<TunePoint> combined(const std::vector<Sweep>& sweeps) {
  std::vector<TunePoint> points{{}};
  for (const Sweep& sweep : sweeps) {
    if (points.size() * (sweep.values.size() + 1) > kMaxPoints)
      throw UsageError(fmt::format("more than {} combinations", kMaxPoints),
                       "sweep fewer values, or without --grid");
    std::vector<TunePoint> next;
    for (const TunePoint& point : points) {
      next.push_back(point);
      for (const std::string& value : sweep.values) {
        next.push_back(point);
        next.back()[sweep.name] = value;
      }
    }
    points = std::move(next);
  }
  return points;
}

}  // namespace

Sweep parse_sweep(const std::string& text) {
  const std::size_t equals = text.find('=');
  Sweep sweep;
  if (equals != std::string::npos) sweep.name = text.substr(0, equals);
  for (std::size_t from = equals; from != std::string::npos;) {
    const std::size_t comma = text.find(',', from + 1);
    sweep.values.push_back(text.substr(from + 1, comma == std::string::npos ? comma : comma - from - 1));
    from = comma;
  }
  const bool blank =
      std::any_of(sweep.values.begin(), sweep.values.end(), [](const auto& v) { return v.empty(); });
  if (sweep.name.empty() || sweep.values.empty() || blank)
    throw UsageError("--sweep " + text + " is not NAME=V1,V2,..",
                     "for example --sweep visual_radius_px=4,6,8,10");
  return sweep;
}

std::string describe(const TunePoint& point) {
  if (point.empty()) return "defaults";
  std::string text;
  for (const auto& [name, value] : point)
    text += fmt::format("{}{}={}", text.empty() ? "" : " ", name, value);
  return text;
}

std::vector<TunePoint> points_of(const std::vector<Sweep>& sweeps, bool grid) {
  std::set<std::string> names;
  for (const Sweep& sweep : sweeps) {
    if (!names.insert(sweep.name).second)
      throw UsageError("--sweep names " + sweep.name + " twice", "list its values in one");
  }
  std::vector<TunePoint> all;
  if (grid) {
    all = combined(sweeps);
  } else {
    all.emplace_back();
    for (const Sweep& sweep : sweeps) {
      for (const std::string& value : sweep.values) all.push_back({{sweep.name, value}});
    }
  }
  std::vector<TunePoint> unique;
  for (TunePoint& point : all) {
    if (std::find(unique.begin(), unique.end(), point) == unique.end()) unique.push_back(std::move(point));
  }
  if (unique.size() > kMaxPoints) throw UsageError(fmt::format("more than {} points", kMaxPoints));
  return unique;
}

TuneParameters apply(TuneParameters parameters, const TunePoint& point) {
  for (const auto& [name, value] : point) {
    if (name == "scoring") {
      parameters.detect.scoring = value;
    } else if (name == "height_tolerance_m") {
      parameters.detect.tolerance.height_m = number(name, value);
    } else if (name == "threshold") {
      parameters.detect.threshold = number(name, value);
    } else if (name == "search_width") {
      parameters.detect.search_width = static_cast<int>(number(name, value));
    } else {
      set_learn_parameter(parameters.learn, name, number(name, value));
    }
  }
  parameters.detect.tolerance.angle_rad = parameters.learn.angle_tolerance_deg * std::numbers::pi / 180;
  parameters.learn.check();
  return parameters;
}

}  // namespace sextant
