// SPDX-License-Identifier: Apache-2.0
// The boxes that prove a claim, as the tree of divisions that makes them from each bin's whole space. One
// character per box, parents before children, one tree per bin in the order of the bins: a digit 0..5 divides
// the box in the middle of that dimension (x, y, distance, rx, ry, rz) after the constraint has shrunk it,
// "." is a box over which the claim holds by its own bound. That the boxes leave no pose out follows from the
// form; nothing has to be searched to check them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "offline/proof/claim.h"

namespace sextant {

/// Divides until the claim holds over every box. Throws std::logic_error where it does not hold: the search
/// that made the claim is wrong.
std::string grow_split_tree(const SearchProblem& problem, const Claim& claim);

/// What a check found.
struct TreeCheck {
  bool well_formed = true;   ///< the text is a tree for these bins
  std::uint64_t boxes = 0;   ///< without children
  std::uint64_t broken = 0;  ///< boxes over which the claim is not established
  Region first_broken;
};
/// Bounds every box anew, one after the other.
TreeCheck check_split_tree(const SearchProblem& problem, const Claim& claim, const std::string& tree);

}  // namespace sextant
