// SPDX-License-Identifier: Apache-2.0
#include "runtime/search/scored_bin.h"

#include <algorithm>
#include <cmath>

#include "runtime/base/error.h"
#include "runtime/search/part_likelihood.h"

namespace sextant {
namespace {

// Where nothing was measured: floors that keep a rendered part's variance from claiming more than a sensor
// can show (4 mm of depth noise and warp, 1.2 px at 1 m and f = 525 of edges), and plain shares.
constexpr double kDepthFloor = 0.004;
constexpr double kEdgeFloor = 1.2 / 525;

/// What one part contributes: gain where it fits perfectly, radius at which it stops mattering.
struct PartTerms {
  double gain = 0;  ///< score of a perfect fit
  double variance = 0;
  double radius2 = 0;
  double missing = 0;  ///< cost of a missing observation
  double scale = 1;
  double near_radius2 = 0;  ///< radius2 of depth nearer than expected
};

PartTerms likelihood_terms(const PartStatistics& seen, double spread, int dimensions, double scale,
                           double occluder_share) {
  const PartLikelihood likelihood = likelihood_of(seen, dimensions);
  PartTerms t;
  t.variance = spread;
  t.gain = likelihood.gain;
  t.radius2 = 2 * spread * (likelihood.gain - likelihood.out);
  t.near_radius2 = 2 * spread * (likelihood.gain - occluder_share * likelihood.out);
  t.missing = scale * t.gain;
  t.scale = scale;
  return t;
}

PartTerms visual_terms(const VisualPart& part, const ScoringOptions& options) {
  if (options.scoring == Scoring::kThesis) {
    return {0, part.variance, static_cast<double>(part.radius) * part.radius, 0};
  }
  const double unmeasured = static_cast<double>(part.variance) / 2 + kEdgeFloor * kEdgeFloor;
  return likelihood_terms(part.seen, part.seen.spread > 0 ? part.seen.spread : unmeasured, 2,
                          options.visual_scale * static_cast<double>(part.seen.weight), 1);
}

PartTerms depth_terms(const DepthPart& part, const ScoringOptions& options) {
  const double variance = part.variance;
  if (options.scoring == Scoring::kThesis) {
    const double radius2 = static_cast<double>(part.radius) * part.radius;
    const double missing = static_cast<double>(part.missing) * part.missing / (2 * variance);
    return {0, variance, radius2, missing, 1, radius2};
  }
  const double unmeasured = variance + kDepthFloor * kDepthFloor;
  return likelihood_terms(part.seen, part.seen.spread > 0 ? part.seen.spread : unmeasured, 1,
                          (part.role == DepthRole::kTable ? options.table_scale : options.depth_scale) *
                              static_cast<double>(part.seen.weight),
                          options.occluder_share);
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

ScoredBin score_bin(const ViewpointBin& bin, const ScoringOptions& options) {
  ScoredBin out;
  out.box = bin.box;
  out.extent = bin.extent;
  for (const VisualPart& part : bin.visual) {
    const PartTerms t = visual_terms(part, options);
    out.visual.kind.push_back(part.kind);
    for (std::size_t i = 0; i < 4; ++i) {
      out.visual.u[i].push_back(part.u[i]);
      out.visual.v[i].push_back(part.v[i]);
    }
    out.visual.radius2.push_back(static_cast<float>(t.radius2));
    out.visual.weight.push_back(static_cast<float>(0.5 * t.scale / t.variance));
    const float miss = out.visual.radius2.back() * out.visual.weight.back();
    const bool unknown = options.outside_is_unknown && options.scoring == Scoring::kLikelihood;
    out.visual.outside_cost.push_back(unknown ? std::min(miss, static_cast<float>(t.missing)) : miss);
    out.offset += t.scale * t.gain;
    out.worst += t.scale * (t.gain - t.radius2 / (2 * t.variance));
    out.largest_visual_radius = std::max(out.largest_visual_radius, static_cast<float>(std::sqrt(t.radius2)));
  }
  for (const DepthPart& part : bin.depth) {
    if (options.scoring == Scoring::kThesis && part.role != DepthRole::kObject) continue;
    const PartTerms t = depth_terms(part, options);
    out.depth.px.push_back(part.px);
    out.depth.py.push_back(part.py);
    for (std::size_t i = 0; i < 4; ++i) out.depth.d[i].push_back(part.d[i]);
    out.depth.radius2.push_back(static_cast<float>(t.radius2));
    out.depth.near_radius2.push_back(static_cast<float>(t.near_radius2));
    out.depth.weight.push_back(static_cast<float>(0.5 * t.scale / t.variance));
    out.depth.missing_cost.push_back(static_cast<float>(t.missing));
    out.offset += t.scale * t.gain;
    out.worst += t.scale * t.gain - std::max(t.scale * t.radius2 / (2 * t.variance), t.missing);
  }
  out.zero = options.scoring == Scoring::kThesis ? out.worst : 0;
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

double default_threshold(const std::vector<ScoredBin>& bins, double share) {
  double sum = 0;
  for (const ScoredBin& bin : bins) sum += bin.zero + share * (bin.offset - bin.zero);
  return bins.empty() ? 0 : sum / static_cast<double>(bins.size());
}

std::vector<ScoredBin> score_bins(const ObjectModel& model, const ScoringOptions& options) {
  std::vector<ScoredBin> bins;
  bins.reserve(model.bins.size());
  for (const ViewpointBin& bin : model.bins) bins.push_back(score_bin(bin, options));
  return bins;
}

}  // namespace sextant
