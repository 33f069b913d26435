// SPDX-License-Identifier: Apache-2.0
// Which parameter values are to be tried: the thesis's experiment (section 6.2) varies one at a time around
// the defaults; a grid varies all of them together.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "offline/learn/parameters.h"
#include "runtime/detect/detector.h"

namespace sextant {

/// Values of one parameter, in the order given.
struct Sweep {
  std::string name;
  std::vector<std::string> values;
};

/// "NAME=V1,V2,.." Throws UsageError.
Sweep parse_sweep(const std::string& text);

/// The parameters that differ from the defaults, by name. Empty: the defaults.
using TunePoint = std::map<std::string, std::string>;

/// "defaults", or "a=1 b=2".
std::string describe(const TunePoint& point);

/// The defaults first, then every value of every sweep alone, or (grid) every combination. No point twice.
/// Throws UsageError for a parameter that is swept twice, and for more than 10000 points.
std::vector<TunePoint> points_of(const std::vector<Sweep>& sweeps, bool grid);

/// All that a trial needs to know.
struct TuneParameters {
  LearnParameters learn;
  DetectOptions detect;
};

/// Names beside those of the learning parameters: height_tolerance_m, threshold, scoring, search_width.
/// angle_tolerance_deg is both learnt for and searched with. Throws UsageError for an unknown name or a bad
/// value.
TuneParameters apply(TuneParameters parameters, const TunePoint& point);

}  // namespace sextant
