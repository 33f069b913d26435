// SPDX-License-Identifier: Apache-2.0
// One configuration key, declared once: where its value lives, its unit, range and meaning. Reading, checking
// and the printed reference all derive from this declaration (daemon_config.cpp holds the list).
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace sextant {

/// Where the value of a key is stored. optional<double> is written "auto" where it is empty.
using ConfigTarget =
    std::variant<bool*, int*, double*, std::optional<double>*, std::string*, std::vector<std::string>*>;

/// A key of the YAML file: `section` is its parent map.
struct ConfigField {
  std::string section;
  std::string key;
  ConfigTarget target;
  std::string text;  ///< what it does, one or two sentences
  std::string unit{};
  double lowest = -std::numeric_limits<double>::infinity();  ///< of numbers, inclusive
  double highest = std::numeric_limits<double>::infinity();  ///< of numbers, inclusive
  std::vector<std::string> choices{};                        ///< of text; empty: any
  std::function<bool(const std::string&)> accepts{};         ///< of text; empty: any
  std::string accepted_form{};                               ///< what `accepts` accepts, in words
  bool reloads = false;  ///< SIGHUP and `sextant ask reload` apply a change
};

/// A section with its heading for the reference.
struct ConfigSection {
  std::string name;
  std::string text;
};

}  // namespace sextant
