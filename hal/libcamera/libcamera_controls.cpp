// SPDX-License-Identifier: Apache-2.0
#include "hal/libcamera/libcamera_controls.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "hal/live/control_request.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace lc = libcamera;

std::optional<double> number_of(const lc::ControlValue& value) {
  if (value.isArray()) return std::nullopt;
  switch (value.type()) {
    case lc::ControlTypeBool:
      return value.get<bool>() ? 1 : 0;
    case lc::ControlTypeByte:
      return value.get<std::uint8_t>();
    case lc::ControlTypeInteger32:
      return value.get<std::int32_t>();
    case lc::ControlTypeInteger64:
      return static_cast<double>(value.get<std::int64_t>());
    case lc::ControlTypeFloat:
      return static_cast<double>(value.get<float>());
    default:
      return std::nullopt;
  }
}

/// A value of the control's type; nothing for types that are no single number.
std::optional<lc::ControlValue> value_of(lc::ControlType type, double number) {
  switch (type) {
    case lc::ControlTypeBool:
      return lc::ControlValue(number != 0);
    case lc::ControlTypeByte:
      return lc::ControlValue(static_cast<std::uint8_t>(number));
    case lc::ControlTypeInteger32:
      return lc::ControlValue(static_cast<std::int32_t>(number));
    case lc::ControlTypeInteger64:
      return lc::ControlValue(static_cast<std::int64_t>(number));
    case lc::ControlTypeFloat:
      return lc::ControlValue(static_cast<float>(number));
    default:
      return std::nullopt;
  }
}

std::optional<double> read_number(const std::string& text) {
  if (text == "true") return 1;
  if (text == "false") return 0;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::string names_of(const lc::Camera& camera) {
  std::string text;
  for (const auto& [id, info] : camera.controls()) text += (text.empty() ? "" : ", ") + id->name();
  return text.empty() ? "none" : text;
}

}  // namespace

std::vector<CameraControl> list_libcamera_controls(const lc::Camera& camera) {
  std::vector<CameraControl> list;
  for (const auto& [id, info] : camera.controls()) {
    const auto lowest = number_of(info.min());
    const auto highest = number_of(info.max());
    if (!lowest || !highest) continue;
    CameraControl control;
    control.name = id->name();
    control.title = id->name();
    control.lowest = static_cast<std::int64_t>(*lowest);
    control.highest = static_cast<std::int64_t>(*highest);
    control.standard = static_cast<std::int64_t>(number_of(info.def()).value_or(*lowest));
    list.push_back(std::move(control));
  }
  return list;
}

void add_libcamera_controls(lc::ControlList& controls, const lc::Camera& camera,
                            const std::vector<std::string>& requests, const std::string& where) {
  for (const std::string& request : requests) {
    const std::size_t equals = request.find('=');
    if (equals == std::string::npos)
      throw DeviceError(where, fmt::format("control '{}' is no Name=value", request),
                        "write, for example, AnalogueGain=2.5");
    const std::string name = request.substr(0, equals);
    const lc::ControlId* found = nullptr;
    const lc::ControlInfo* range = nullptr;
    for (const auto& [id, info] : camera.controls()) {
      if (control_name(id->name()) != control_name(name)) continue;
      found = id;
      range = &info;
    }
    if (found == nullptr)
      throw DeviceError(where, fmt::format("it has no control '{}'", name), "it has " + names_of(camera));
    const auto number = read_number(request.substr(equals + 1));
    const auto lowest = number_of(range->min());
    const auto highest = number_of(range->max());
    const auto value = number ? value_of(found->type(), *number) : std::nullopt;
    if (!value || (lowest && *number < *lowest) || (highest && *number > *highest))
      throw DeviceError(where, fmt::format("control {} cannot be '{}'", name, request.substr(equals + 1)),
                        "use " + range->toString());
    controls.set(found->id(), *value);
  }
}

}  // namespace sextant
