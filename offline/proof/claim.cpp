// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/claim.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/search/bound.h"
#include "runtime/search/evaluate.h"

namespace sextant {

Claim::Claim(const SearchProblem& problem, const SearchOutcome& outcome, int max_detections, double threshold)
    : problem_(problem),
      found_(outcome.found),
      complete_(outcome.complete),
      max_detections_(max_detections),
      threshold_(threshold),
      upper_bound_(outcome.upper_bound) {
  for (const ScoredPose& f : found_) {
    boxes_.push_back(
        box_of(problem.bins[static_cast<std::size_t>(f.pose.bin)], problem.tables.camera().focal, f.pose));
  }
}

bool Claim::Limit::admits(double bound, const LatticePose& first) const {
  if (bound < score) return true;
  if (bound > score) return false;
  return tie == kReachable || (tie == kByOrder && !(first < pose));
}

std::optional<std::size_t> Claim::first_that_suppresses(const Region& region) const {
  const double focal = problem_.tables.camera().focal;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const bool does = region.single() ? intersection_over_union(box_of(bin_of(region), focal, region.first()),
                                                                boxes_[i]) > kSuppressionIou
                                      : suppressed_everywhere(bin_of(region), focal, region, boxes_[i]);
    if (does) return i;
  }
  return std::nullopt;
}

std::optional<Claim::Limit> Claim::limit_of(const Region& region) const {
  const auto by = first_that_suppresses(region);
  if (by && !complete_) return std::nullopt;
  if (by) return Limit{found_[*by].score, Limit::kByOrder, found_[*by].pose};
  if (!complete_) return Limit{upper_bound_, Limit::kReachable, {}};
  if (static_cast<int>(found_.size()) == max_detections_) {
    return Limit{found_.back().score, Limit::kByOrder, found_.back().pose};
  }
  return Limit{threshold_, Limit::kStrict, {}};
}

bool Claim::holds_over(const Region& region) const {
  const auto limit = limit_of(region);
  if (!limit) return true;
  if (region.single()) {
    const LatticePose pose = region.first();
    if (!problem_.constraint.contains(pose)) return true;
    if (std::any_of(found_.begin(), found_.end(), [&](const ScoredPose& f) { return f.pose == pose; })) {
      return true;
    }
    return limit->admits(evaluate(bin_of(region), problem_.tables, pose), pose);
  }
  return limit->admits(window_bound(bin_of(region), problem_.tables, region, limit->score), region.first());
}

std::string Claim::wrong_detections() const {
  const double focal = problem_.tables.camera().focal;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const ScoredPose& f = found_[i];
    const auto wrong = [&](const char* what) { return fmt::format("detection {} {}", i + 1, what); };
    const auto& bin = problem_.bins[static_cast<std::size_t>(f.pose.bin)];
    if (!problem_.constraint.whole(f.pose.bin, bin.box).contains(f.pose) ||
        !problem_.constraint.contains(f.pose)) {
      return wrong("is no feasible pose");
    }
    const double score = evaluate(bin, problem_.tables, f.pose);
    if (score != f.score) return wrong("does not have the score that is claimed");
    if (score < threshold_) return wrong("is below the threshold");
    for (std::size_t j = 0; j < i; ++j) {
      if (intersection_over_union(box_of(bin, focal, f.pose), boxes_[j]) > kSuppressionIou) {
        return wrong("is suppressed by a better one");
      }
    }
    if (i > 0 &&
        (found_[i - 1].score < f.score || (found_[i - 1].score == f.score && f.pose < found_[i - 1].pose))) {
      return wrong("is better than the one before it");
    }
  }
  const bool full = static_cast<int>(found_.size()) == max_detections_;
  const double least = full ? std::max(threshold_, found_.back().score) : threshold_;
  if (complete_ ? upper_bound_ != least : upper_bound_ < threshold_) {
    return "the upper bound does not follow from the detections";
  }
  return "";
}

}  // namespace sextant
