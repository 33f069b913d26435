// SPDX-License-Identifier: Apache-2.0
// What a search claims of one object, as a limit for every pose: which score it may have at most without
// contradicting the claim. With the poses found (best first), the claim says of a pose
//   that is one of them: nothing more;
//   that they suppress, the first of them number i: it is not better than number i (complete answers only);
//   of all others: it is not better than the last one found where all that were asked for are found, else
//   below the threshold; above no more than the upper bound where the search ran out of time.
// "Not better" includes the total order of poses that breaks ties.
#pragma once

#include <vector>

#include "runtime/search/branch_and_bound.h"
#include "runtime/search/suppression.h"

namespace sextant {

class Claim {
 public:
  /// The outcome's found, complete and upper_bound count. The problem must outlive the claim.
  Claim(const SearchProblem& problem, const SearchOutcome& outcome, int max_detections, double threshold);

  /// True only if no pose of the region contradicts the claim, as far as one bound (or, for a single pose,
  /// its score) tells. The region must be tightened and not empty.
  bool holds_over(const Region& region) const;
  /// Empty where the detections are what they claim to be: feasible, scored right, in order, none suppressing
  /// another; else what is wrong.
  std::string wrong_detections() const;

 private:
  /// A score that must not be exceeded; reached only by `pose` and what comes after it, or by no pose, or by
  /// any.
  struct Limit {
    double score = 0;
    enum { kStrict, kReachable, kByOrder } tie = kStrict;
    LatticePose pose;
    bool admits(double bound, const LatticePose& first) const;
  };
  /// nothing: no limit.
  std::optional<Limit> limit_of(const Region& region) const;
  std::optional<std::size_t> first_that_suppresses(const Region& region) const;
  const ScoredBin& bin_of(const Region& r) const { return problem_.bins[static_cast<std::size_t>(r.bin)]; }

  const SearchProblem& problem_;
  std::vector<ScoredPose> found_;
  std::vector<Box2> boxes_;
  bool complete_;
  int max_detections_;
  double threshold_;
  double upper_bound_;
};

}  // namespace sextant
