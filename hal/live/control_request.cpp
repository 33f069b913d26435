// SPDX-License-Identifier: Apache-2.0
#include "hal/live/control_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "runtime/base/error.h"

namespace sextant {
namespace {

std::string trimmed(std::string text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_space));
  text.erase(std::find_if_not(text.rbegin(), text.rend(), is_space).base(), text.end());
  return text;
}

std::string range_text(const CameraControl& control) {
  if (control.menu.empty())
    return control.step > 1
               ? fmt::format("{} to {} in steps of {}", control.lowest, control.highest, control.step)
               : fmt::format("{} to {}", control.lowest, control.highest);
  std::string text;
  for (std::size_t i = 0; i < control.menu.size(); ++i) {
    if (control.menu[i].empty()) continue;
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", control.lowest + static_cast<std::int64_t>(i),
                        control.menu[i]);
  }
  return text;
}

std::string names_text(const std::vector<CameraControl>& known) {
  std::string text;
  for (const CameraControl& control : known) {
    if (!control.read_only) text += (text.empty() ? "" : ", ") + control.name;
  }
  return text.empty() ? "none" : text;
}

/// A number, true, false, or a menu entry's text.
bool read_value(const CameraControl& control, const std::string& text, std::int64_t& value) {
  for (std::size_t i = 0; i < control.menu.size(); ++i) {
    if (!control.menu[i].empty() && control_name(control.menu[i]) == control_name(text) &&
        !control_name(text).empty()) {
      value = control.lowest + static_cast<std::int64_t>(i);
      return true;
    }
  }
  if (text == "true" || text == "false") {
    value = text == "true" ? 1 : 0;
    return true;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::string control_name(const std::string& title) {
  std::string name;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

ControlRequest read_control_request(const std::string& text, const std::vector<CameraControl>& known,
                                    const std::string& where) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    throw DeviceError(where, fmt::format("control '{}' is no name=value", text),
                      "write, for example, gain=16");
  const std::string name = control_name(text.substr(0, equals));
  const std::string value_text = trimmed(text.substr(equals + 1));
  const auto control = std::find_if(known.begin(), known.end(), [&](const CameraControl& c) {
    return c.name == name || control_name(c.name) == name;
  });
  if (control == known.end())
    throw DeviceError(where, fmt::format("it has no control '{}'", name), "it has " + names_text(known));
  if (control->read_only)
    throw DeviceError(where, fmt::format("control {} cannot be set", name), "remove it");
  ControlRequest request{&*control, 0};
  const bool is_value = read_value(*control, value_text, request.value);
  const bool inside = request.value >= control->lowest && request.value <= control->highest;
  const std::int64_t entry = request.value - control->lowest;
  const bool exists =
      control->menu.empty() || (inside && entry < static_cast<std::int64_t>(control->menu.size()) &&
                                !control->menu[static_cast<std::size_t>(entry)].empty());
  if (!is_value || !inside || !exists)
    throw DeviceError(where, fmt::format("control {} cannot be '{}'", name, value_text),
                      "use " + range_text(*control));
  return request;
}

}  // namespace sextant
