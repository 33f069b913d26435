// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/config_reference.h"

#include <fmt/format.h>

#include <cmath>
#include <sstream>

namespace sextant {

namespace {

constexpr std::size_t kLineWidth = 110;

constexpr char kPreamble[] =
    "# SPDX-License-Identifier: Apache-2.0\n"
    "# Configuration of sextantd. As shipped it plays the bundled sample in a loop, on a machine without a "
    "camera.\n"
    "# Check a changed copy with: sextantd --config FILE --check-config\n"
    "# This file is made by: sextantd --config FILE --print-config-reference (unknown keys are errors).\n"
    "# Keys marked \"reloads\" may change while the daemon runs: SIGHUP or `sextant ask reload` reads this "
    "file again.\n";

/// Words as comment lines of limited width.
std::string comment(const std::string& text, const std::string& indent) {
  std::string out;
  std::string line = indent + "#";
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > kLineWidth) {
      out.append(line).append("\n");
      line = indent + "#";
    }
    line.append(" ").append(word);
  }
  return out + line + "\n";
}

/// Text as YAML: double-quoted, with everything unusual escaped.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < ' ' || byte == 0x7f) {
      out += fmt::format("\\x{:02x}", byte);
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;  // UTF-8 as it is
  }
  return out + "\"";
}

struct ValueText {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const int* value) const { return fmt::format("{}", *value); }
  std::string operator()(const double* value) const { return fmt::format("{}", *value); }
  std::string operator()(const std::optional<double>* value) const {
    return value->has_value() ? fmt::format("{}", **value) : "auto";
  }
  std::string operator()(const std::string* value) const { return quoted(*value); }
  std::string operator()(const std::vector<std::string>* value) const {
    std::vector<std::string> all;
    for (const std::string& text : *value) all.push_back(quoted(text));
    return fmt::format("[{}]", fmt::join(all, ", "));
  }
};

/// Unit, range and default on a line of their own.
std::string facts(const ConfigField& field, const std::string& default_value) {
  std::string text = field.unit.empty() ? "" : field.unit + ", ";
  if (std::isfinite(field.lowest)) text += fmt::format("{} to {}, ", field.lowest, field.highest);
  if (!field.choices.empty()) text += fmt::format("one of {}; ", fmt::join(field.choices, ", "));
  return fmt::format("[{}default {}{}]", text, default_value, field.reloads ? "; reloads" : "");
}

}  // namespace

std::string config_reference(const DaemonConfig& config) {
  DaemonConfig values = config;
  DaemonConfig defaults;
  const std::vector<ConfigField> fields = config_fields(values);
  const std::vector<ConfigField> default_fields = config_fields(defaults);
  std::string out = kPreamble;
  for (const ConfigSection& section : config_sections()) {
    out += fmt::format("\n{}{}:\n", comment(section.text, ""), section.name);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (fields[i].section != section.name) continue;
      out += comment(fields[i].text, "  ");
      out += comment(facts(fields[i], std::visit(ValueText(), default_fields[i].target)), "  ");
      out += fmt::format("  {}: {}\n", fields[i].key, std::visit(ValueText(), fields[i].target));
    }
  }
  return out;
}

}  // namespace sextant
