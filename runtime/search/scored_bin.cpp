// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/scored_bin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/base/error.h"

namespace sextant {
namespace {

// Floors that keep a rendered part's variance from claiming more than a sensor can show: 4 mm of depth noise
// and warp, 1.2 px (at 1 m, f = 525) of edge localisation and colour-depth misregistration.
constexpr double kDepthFloor = 0.004;
constexpr double kEdgeFloor = 1.2 / 525;
// Share of a part's features that the sensor finds where they should be.
constexpr double kFoundShare = 0.75;
// Background: depth is anywhere within half a metre; edges of one direction are found at this density.
constexpr double kBackgroundDepthSpan = 0.5;                      // metres
constexpr double kBackgroundEdgeDensity = 0.008 * 525.0 * 525.0;  // per (tangent * metre)^2 at 1 m

/// What one part contributes: gain where it fits perfectly, radius at which it stops mattering.
struct PartTerms {
  double gain = 0;  ///< score of a perfect fit
  double variance = 0;
  double radius2 = 0;
  double missing = 0;  ///< cost of a missing observation
};

/// log(p_object / p_background) of a Gaussian in-state against the out-state: gain - min(d^2, r^2) / (2 v),
/// where the clip is what an absent feature says: log(1 - found share).
PartTerms likelihood_terms(double variance, double peak_ratio) {
  PartTerms t;
  t.variance = variance;
  t.gain = std::max(0.05, std::log(1 - kFoundShare + kFoundShare * peak_ratio));
  const double out = std::log(1 - kFoundShare);
  t.radius2 = 2 * variance * (t.gain - out);
  t.missing = t.gain;
  return t;
}

PartTerms visual_terms(const VisualPart& part, Scoring scoring) {
  if (scoring == Scoring::kThesis) {
    return {0, part.variance, static_cast<double>(part.radius) * part.radius, 0};
  }
  const double v = static_cast<double>(part.variance) / 2 + kEdgeFloor * kEdgeFloor;  // per axis
  return likelihood_terms(v, 1 / (2 * std::numbers::pi * v * kBackgroundEdgeDensity));
}

PartTerms depth_terms(const DepthPart& part, Scoring scoring) {
  const double variance = part.variance;
  if (scoring == Scoring::kThesis) {
    return {0, variance, static_cast<double>(part.radius) * part.radius,
            static_cast<double>(part.missing) * part.missing / (2 * variance)};
  }
  const double v = variance + kDepthFloor * kDepthFloor;
  return likelihood_terms(v, kBackgroundDepthSpan / std::sqrt(2 * std::numbers::pi * v));
}

/// Mean over the parts of |coefficient of angle a| / radius.
template <typename Parts>
std::array<double, 3> mean_effect(const Parts& parts,
                                  const std::vector<const std::array<std::vector<float>, 4>*>& rows) {
  std::array<double, 3> effect{};
  if (parts.size() == 0) return effect;
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
      double square = 0;
      for (const auto* row : rows) square += std::pow((*row)[a + 1][i], 2);
      effect[a] += std::sqrt(square / parts.radius2[i]);
    }
    effect[a] /= static_cast<double>(parts.size());
  }
  return effect;
}

double mean_radius(const std::vector<float>& radius2) {
  double sum = 0;
  for (const float r2 : radius2) sum += std::sqrt(static_cast<double>(r2));
  return radius2.empty() ? 0 : sum / static_cast<double>(radius2.size());
}

ScoredBin score_bin(const ViewpointBin& bin, Scoring scoring) {
  ScoredBin out;
  out.box = bin.box;
  out.extent = bin.extent;
  for (const VisualPart& part : bin.visual) {
    const PartTerms t = visual_terms(part, scoring);
    out.visual.kind.push_back(part.kind);
    for (std::size_t i = 0; i < 4; ++i) {
      out.visual.u[i].push_back(part.u[i]);
      out.visual.v[i].push_back(part.v[i]);
    }
    out.visual.radius2.push_back(static_cast<float>(t.radius2));
    out.visual.weight.push_back(static_cast<float>(0.5 / t.variance));
    out.offset += t.gain;
    out.worst += t.gain - t.radius2 / (2 * t.variance);
    out.largest_visual_radius = std::max(out.largest_visual_radius, static_cast<float>(std::sqrt(t.radius2)));
  }
  for (const DepthPart& part : bin.depth) {
    const PartTerms t = depth_terms(part, scoring);
    out.depth.px.push_back(part.px);
    out.depth.py.push_back(part.py);
    for (std::size_t i = 0; i < 4; ++i) out.depth.d[i].push_back(part.d[i]);
    out.depth.radius2.push_back(static_cast<float>(t.radius2));
    out.depth.weight.push_back(static_cast<float>(0.5 / t.variance));
    out.depth.missing_cost.push_back(static_cast<float>(t.missing));
    out.offset += t.gain;
    out.worst += t.gain - std::max(t.radius2 / (2 * t.variance), t.missing);
  }
  out.zero = scoring == Scoring::kThesis ? out.worst : 0;
  out.visual_effect = mean_effect(out.visual, {&out.visual.u, &out.visual.v});
  out.depth_effect = mean_effect(out.depth, {&out.depth.d});
  out.mean_visual_radius = mean_radius(out.visual.radius2);
  out.mean_depth_radius = mean_radius(out.depth.radius2);
  return out;
}

}  // namespace

Scoring scoring_from_name(const std::string& name) {
  if (name == "thesis") return Scoring::kThesis;
  if (name == "likelihood") return Scoring::kLikelihood;
  throw UsageError("no scoring is called \"" + name + "\"", "use likelihood or thesis");
}

double evidence_share(const ScoredBin& bin, double score) {
  const double span = bin.offset - bin.zero;
  return span > 0 ? std::clamp((score - bin.zero) / span, 0.0, 1.0) : 0.0;
}

double default_threshold(const std::vector<ScoredBin>& bins) {
  constexpr double kShare = 0.35;
  double sum = 0;
  for (const ScoredBin& bin : bins) sum += bin.zero + kShare * (bin.offset - bin.zero);
  return bins.empty() ? 0 : sum / static_cast<double>(bins.size());
}

std::vector<ScoredBin> score_bins(const ObjectModel& model, Scoring scoring) {
  std::vector<ScoredBin> bins;
  bins.reserve(model.bins.size());
  for (const ViewpointBin& bin : model.bins) bins.push_back(score_bin(bin, scoring));
  return bins;
}

}  // namespace sextant
