// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/split_tree.h"

#include <fmt/format.h>

#include <stdexcept>

#include "runtime/search/branching.h"

namespace sextant {
namespace {

constexpr char kLeaf = '.';

std::pair<Region, Region> divided(const Region& region, std::size_t dimension) {
  const auto middle = static_cast<std::int16_t>((region.lo[dimension] + region.hi[dimension]) >> 1);
  std::pair<Region, Region> parts{region, region};
  parts.first.hi[dimension] = middle;
  parts.second.lo[dimension] = static_cast<std::int16_t>(middle + 1);
  return parts;
}

class Grower {
 public:
  Grower(const SearchProblem& problem, const Claim& claim) : problem_(problem), claim_(claim) {}

  void grow(const Region& untightened) {
    const Region region = problem_.constraint.tightened(untightened);
    if (region.empty() || claim_.holds_over(region)) {
      tree += kLeaf;
      return;
    }
    if (region.single()) {
      throw std::logic_error(fmt::format("pose {} {} {} {} {} {} of bin {} contradicts the search",
                                         region.lo[kX], region.lo[kY], region.lo[kZ], region.lo[kRx],
                                         region.lo[kRy], region.lo[kRz], region.bin));
    }
    const ScoredBin& bin = problem_.bins[static_cast<std::size_t>(region.bin)];
    const Region half = halves(bin, problem_.bounding_radius_m, problem_.tables.camera().focal, region).first;
    std::size_t dimension = 0;
    while (half.hi[dimension] == region.hi[dimension]) ++dimension;
    tree += static_cast<char>('0' + dimension);
    const auto [first, second] = divided(region, dimension);
    grow(first);
    grow(second);
  }

  std::string tree;

 private:
  const SearchProblem& problem_;
  const Claim& claim_;
};

class Checker {
 public:
  Checker(const SearchProblem& problem, const Claim& claim, const std::string& tree)
      : problem_(problem), claim_(claim), tree_(tree) {}

  TreeCheck run() {
    for (std::size_t i = 0; i < problem_.bins.size() && check_.well_formed; ++i) {
      visit(problem_.constraint.whole(static_cast<int>(i), problem_.bins[i].box));
    }
    check_.well_formed = check_.well_formed && at_ == tree_.size();
    return check_;
  }

 private:
  /// The depth is limited by the sizes of a box: every division halves one.
  void visit(const Region& untightened) {
    const char what = at_ < tree_.size() ? tree_[at_++] : '\0';
    const Region region = problem_.constraint.tightened(untightened);
    if (what == kLeaf) {
      ++check_.boxes;
      if (region.empty() || claim_.holds_over(region)) return;
      if (check_.broken++ == 0) check_.first_broken = region;
      return;
    }
    const auto dimension = static_cast<std::size_t>(what - '0');
    if (what < '0' || dimension >= kDimensions || region.empty() ||
        region.lo[dimension] == region.hi[dimension]) {
      check_.well_formed = false;
      return;
    }
    const auto [first, second] = divided(region, dimension);
    visit(first);
    if (check_.well_formed) visit(second);
  }

  const SearchProblem& problem_;
  const Claim& claim_;
  const std::string& tree_;
  std::size_t at_ = 0;
  TreeCheck check_;
};

}  // namespace

std::string grow_split_tree(const SearchProblem& problem, const Claim& claim) {
  Grower grower(problem, claim);
  for (std::size_t i = 0; i < problem.bins.size(); ++i) {
    grower.grow(problem.constraint.whole(static_cast<int>(i), problem.bins[i].box));
  }
  return grower.tree;
}

TreeCheck check_split_tree(const SearchProblem& problem, const Claim& claim, const std::string& tree) {
  return Checker(problem, claim, tree).run();
}

}  // namespace sextant
