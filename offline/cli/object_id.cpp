// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/object_id.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace sextant {

std::optional<int> object_id_in_name(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  const auto digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  const auto first = std::find_if(stem.begin(), stem.end(), digit);
  const auto last = std::find_if_not(first, stem.end(), digit);
  if (first == last || last - first > 9) return std::nullopt;
  return std::stoi(std::string(first, last));
}

}  // namespace sextant
