// SPDX-License-Identifier: Apache-2.0
// "Did you mean ...?" for a mistyped name.
#pragma once

#include <string>
#include <vector>

namespace sextant {

/// Levenshtein distance of two names. O(|a| |b|).
int edit_distance(const std::string& a, const std::string& b);

/// The known name with the smallest edit distance (the first of equals); empty where none is near: at most a
/// third of the longer name's letters, and at least one, may differ.
std::string nearest_name(const std::string& name, const std::vector<std::string>& known);

}  // namespace sextant
