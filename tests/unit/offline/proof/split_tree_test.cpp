// SPDX-License-Identifier: Apache-2.0
// Proofs of what brute force finds hold; proofs of anything else do not.
#include "offline/proof/split_tree.h"

#include <gtest/gtest.h>

#include "runtime/search/reference/brute_force.h"
#include "small_space.h"

namespace sextant {
namespace {

/// Grows a tree for the true claim and checks another claim with it.
TreeCheck check(const SearchProblem& problem, const SearchOutcome& truth, const SearchOutcome& claimed,
                const SearchOptions& o) {
  const Claim right(problem, truth, o.max_detections, o.threshold);
  const Claim other(problem, claimed, o.max_detections, o.threshold);
  return check_split_tree(problem, other, grow_split_tree(problem, right));
}

SearchOutcome truth_of(const SmallSpace& s, const SearchOptions& o) {
  SearchOutcome truth = brute_force(s.search(), s.space, o);
  const bool full = static_cast<int>(truth.found.size()) == o.max_detections;
  truth.upper_bound = full ? std::max(o.threshold, truth.found.back().score) : o.threshold;
  return truth;
}

TEST(SplitTree, ProvesWhatBruteForceFinds) {
  int detections = 0, absent = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const SmallSpace s(seed, 16, 12, 0.9, 0.91);
    SearchOptions o;
    o.max_detections = seed % 2 ? 1 : 3;
    o.threshold = seed % 3 ? -300 : 0;
    const SearchProblem problem = s.search();
    const SearchOutcome truth = truth_of(s, o);
    EXPECT_EQ(Claim(problem, truth, o.max_detections, o.threshold).wrong_detections(), "");
    const TreeCheck holds = check(problem, truth, truth, o);
    EXPECT_TRUE(holds.well_formed);
    EXPECT_EQ(holds.broken, 0U) << "seed " << seed;
    EXPECT_GE(holds.boxes, s.bins.size());
    (truth.found.empty() ? absent : detections) += 1;
    if (truth.found.empty()) continue;
    // A worse pose in the place of the best, or no pose: the best one contradicts.
    SearchOutcome worse = truth;
    worse.found.erase(worse.found.begin());
    worse.upper_bound = o.threshold;
    EXPECT_GT(check(problem, truth, worse, o).broken, 0U) << "seed " << seed;
    // The same pose, said to be less good.
    SearchOutcome wrong_score = truth;
    wrong_score.found[0].score += 1e-9;
    EXPECT_NE(Claim(problem, wrong_score, o.max_detections, o.threshold).wrong_detections(), "");
    SearchOutcome elsewhere = truth;
    elsewhere.found[0].pose.at[kRz] = static_cast<std::int16_t>(elsewhere.found[0].pose.at[kRz] + 400);
    EXPECT_NE(Claim(problem, elsewhere, o.max_detections, o.threshold).wrong_detections(), "");
    SearchOutcome bound = truth;
    bound.upper_bound += 1;
    EXPECT_NE(Claim(problem, bound, o.max_detections, o.threshold).wrong_detections(), "");
  }
  EXPECT_GT(detections, 3);
  EXPECT_GT(absent, 0);
}

TEST(SplitTree, ABoundedAnswerIsProvenUpToItsBound) {
  const SmallSpace s(3, 16, 12, 0.9, 0.91);
  SearchOptions o;
  o.threshold = -1e6;
  const SearchOutcome truth = truth_of(s, o);
  ASSERT_FALSE(truth.found.empty());
  SearchOutcome bounded;
  bounded.complete = false;
  bounded.upper_bound = truth.found[0].score;
  EXPECT_EQ(check(s.search(), bounded, bounded, o).broken, 0U);
  SearchOutcome too_low = bounded;
  too_low.upper_bound = std::nextafter(truth.found[0].score, -1e9);
  EXPECT_GT(check(s.search(), bounded, too_low, o).broken, 0U);
}

TEST(SplitTree, TheGrowerNoticesAWrongAnswer) {
  const SmallSpace s(3, 16, 12, 0.9, 0.91);
  SearchOptions o;
  o.threshold = -1e6;
  SearchOutcome none = truth_of(s, o);
  ASSERT_FALSE(none.found.empty());
  none.found.clear();
  none.upper_bound = o.threshold;
  const SearchProblem problem = s.search();
  const Claim claim(problem, none, 1, o.threshold);
  EXPECT_THROW(grow_split_tree(problem, claim), std::logic_error);
}

TEST(SplitTree, DamagedTreesAreNoTreesOrProveNothing) {
  const SmallSpace s(1, 16, 12, 0.9, 0.91);
  SearchOptions o;
  o.threshold = -1e6;
  const SearchOutcome truth = truth_of(s, o);
  const SearchProblem problem = s.search();
  const Claim claim(problem, truth, 1, o.threshold);
  const std::string tree = grow_split_tree(problem, claim);
  ASSERT_GT(tree.size(), 20U);
  int malformed = 0, broken = 0;
  for (std::size_t i = 0; i < tree.size(); i += 1 + tree.size() / 200) {
    for (const char c : {'.', '0', '5', '6', '/', '\0', '\xff'}) {
      std::string damaged = tree;
      damaged[i] = c;
      if (damaged == tree) continue;
      const TreeCheck check = check_split_tree(problem, claim, damaged);
      malformed += check.well_formed ? 0 : 1;
      broken += check.broken > 0 ? 1 : 0;
    }
    EXPECT_FALSE(check_split_tree(problem, claim, tree.substr(0, i)).well_formed);
  }
  EXPECT_FALSE(check_split_tree(problem, claim, tree + ".").well_formed);
  EXPECT_FALSE(check_split_tree(problem, claim, std::string(100000, '0')).well_formed);
  EXPECT_GT(malformed, 50);
  EXPECT_GT(broken, 0);
}

}  // namespace
}  // namespace sextant
