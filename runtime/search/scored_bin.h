// SPDX-License-Identifier: Apache-2.0
// A viewpoint bin ready to be scored: parts as structures of arrays, and for each part what a look-up costs.
// Every scoring has the same form, so that one search serves all of them:
//     score(pose) = offset - sum of min(difference^2, radius^2) / (2 variance)
// `thesis` is eqs. 3.5 and 3.8 as they stand (offset 0). `likelihood` is the log-likelihood ratio of each
// part's feature against the background, with an explicit "out" state (Davies 2015, sec. 3.4, normalised):
// a part found at its expected place speaks for the object, one that is not speaks against it, one that
// cannot be seen says nothing; scores compare across bins, models and frames.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

enum class Scoring : std::uint8_t { kThesis, kLikelihood };

/// "thesis" or "likelihood"; throws UsageError otherwise.
Scoring scoring_from_name(const std::string& name);

/// How parts are turned into costs.
struct ScoringOptions {
  Scoring scoring = Scoring::kLikelihood;
  // Parts of one kind err together (a warp of the depth, a shadow's edge), so that their evidence does not
  // simply add up: each kind's likelihood ratios are multiplied by its scale, 0..10.
  double visual_scale = 1;
  double depth_scale = 2;
  double table_scale = 2;
  /// Edges that fall outside of the image say nothing, as depth there does; false: they count as misses.
  bool outside_is_unknown = true;
  /// Depth nearer than expected may be something in front of the object: it says this share, 0..1, of what
  /// depth that is farther says, which the object cannot explain.
  double occluder_share = 0.3;

  ScoringOptions() = default;
  ScoringOptions(Scoring s) : scoring(s) {}  // NOLINT(google-explicit-constructor): a scoring and defaults
};

/// Structure of arrays over the visual parts of a bin.
struct VisualParts {
  std::vector<std::uint8_t> kind;
  std::array<std::vector<float>, 4> u;  ///< coefficients of 1, rx, ry, rz; tangent * metre
  std::array<std::vector<float>, 4> v;
  std::vector<float> radius2;  ///< (tangent * metre)^2
  std::vector<float> weight;   ///< 1 / (2 variance)
  /// Cost where the part falls outside of the image: radius2 * weight (a miss), or less (nobody knows).
  std::vector<float> outside_cost;
  std::size_t size() const { return kind.size(); }
};

/// Structure of arrays over the depth parts of a bin.
struct DepthParts {
  std::vector<float> px, py;            ///< tangent * metre
  std::array<std::vector<float>, 4> d;  ///< coefficients of 1, rx, ry, rz; metres
  std::vector<float> radius2;           ///< m^2
  std::vector<float> weight;            ///< 1 / (2 variance)
  /// The same where the depth is nearer than expected, <= radius2.
  std::vector<float> near_radius2;
  std::vector<float> missing_cost;  ///< cost where depth is missing
  std::size_t size() const { return px.size(); }
};

/// One bin under one scoring.
struct ScoredBin {
  RotationBox box;
  VisualParts visual;
  DepthParts depth;
  double offset = 0;                ///< score of a pose at which every part fits perfectly
  double worst = 0;                 ///< score of a pose at which no part fits
  double zero = 0;                  ///< score that counts as "no evidence": 0, or `worst` for thesis
  std::array<float, 4> extent{};    ///< 2D box around the centre, tangent * metre
  float largest_visual_radius = 0;  ///< tangent * metre
  /// Mean change of a part's pixel (tangent * metre per radian) and depth (metres per radian) with rx, ry,
  /// rz, in units of its receptive field; and what a change of distance or pixel does. Guides the splitting.
  std::array<double, 3> visual_effect{};
  std::array<double, 3> depth_effect{};
  double mean_visual_radius = 0;
  double mean_depth_radius = 0;
};

/// A score as a share of the best possible evidence, 0..1: (score - zero) / (offset - zero).
double evidence_share(const ScoredBin& bin, double score);

/// The threshold used where the user gives none: this share of the evidence of the average bin.
inline constexpr double kDefaultEvidenceShare = 0.10;
double default_threshold(const std::vector<ScoredBin>& bins, double share = kDefaultEvidenceShare);

std::vector<ScoredBin> score_bins(const ObjectModel& model, const ScoringOptions& options);

}  // namespace sextant
