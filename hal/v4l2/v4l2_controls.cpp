// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/v4l2_controls.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "hal/live/control_request.h"
#include "hal/live/stream_session.h"

namespace sextant {
namespace {

constexpr int kMostControls = 1000;
constexpr std::int64_t kLongestMenu = 64;

bool is_number(std::uint32_t type) {
  switch (type) {
    case V4L2_CTRL_TYPE_INTEGER:
    case V4L2_CTRL_TYPE_INTEGER64:
    case V4L2_CTRL_TYPE_BOOLEAN:
    case V4L2_CTRL_TYPE_MENU:
    case V4L2_CTRL_TYPE_INTEGER_MENU:
    case V4L2_CTRL_TYPE_BITMASK:
    case V4L2_CTRL_TYPE_BUTTON:
      return true;
    default:
      return false;
  }
}

std::vector<std::string> menu_of(const V4l2Device& device, const v4l2_query_ext_ctrl& control) {
  std::vector<std::string> menu;
  const bool numbers = control.type == V4L2_CTRL_TYPE_INTEGER_MENU;
  if (!numbers && control.type != V4L2_CTRL_TYPE_MENU) return menu;
  for (std::int64_t i = control.minimum; i <= control.maximum && i < control.minimum + kLongestMenu; ++i) {
    v4l2_querymenu entry{};
    entry.id = control.id;
    entry.index = static_cast<std::uint32_t>(i);
    const bool there = device.call(VIDIOC_QUERYMENU, &entry) == 0;
    menu.push_back(!there    ? std::string()
                   : numbers ? std::to_string(entry.value)
                             : std::string(reinterpret_cast<const char*>(entry.name)));
  }
  return menu;
}

/// One value, read or set through the interface that also carries 64 bits.
int transfer(const V4l2Device& device, std::uint32_t id, bool wide, bool set, std::int64_t& value) {
  v4l2_ext_control control{};
  control.id = id;
  if (wide) {
    control.value64 = value;
  } else {
    control.value = static_cast<std::int32_t>(value);
  }
  v4l2_ext_controls controls{};
  controls.which = V4L2_CTRL_WHICH_CUR_VAL;
  controls.count = 1;
  controls.controls = &control;
  const int error = device.call(set ? VIDIOC_S_EXT_CTRLS : VIDIOC_G_EXT_CTRLS, &controls);
  if (error == 0) value = wide ? control.value64 : control.value;
  return error;
}

struct Listed {
  CameraControl control;
  std::uint32_t id = 0;
  bool wide = false;
};

std::vector<Listed> query_all(const V4l2Device& device) {
  std::vector<Listed> all;
  v4l2_query_ext_ctrl query{};
  for (int i = 0; i < kMostControls; ++i) {
    query.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    if (device.call(VIDIOC_QUERY_EXT_CTRL, &query) != 0) break;
    if (!is_number(query.type) || (query.flags & V4L2_CTRL_FLAG_DISABLED) != 0 || query.nr_of_dims != 0)
      continue;
    Listed entry;
    entry.id = query.id;
    entry.wide = query.type == V4L2_CTRL_TYPE_INTEGER64;
    entry.control.title = query.name;
    entry.control.name = control_name(query.name);
    entry.control.lowest = query.minimum;
    entry.control.highest = query.type == V4L2_CTRL_TYPE_BUTTON ? 1 : query.maximum;
    entry.control.step = static_cast<std::int64_t>(query.step);
    entry.control.standard = query.default_value;
    entry.control.read_only = (query.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
    entry.control.menu = menu_of(device, query);
    std::int64_t value = 0;
    if ((query.flags & V4L2_CTRL_FLAG_WRITE_ONLY) == 0 &&
        transfer(device, query.id, entry.wide, false, value) == 0)
      entry.control.value = value;
    all.push_back(std::move(entry));
  }
  return all;
}

}  // namespace

std::vector<CameraControl> list_controls(const V4l2Device& device) {
  std::vector<CameraControl> controls;
  for (Listed& entry : query_all(device)) controls.push_back(std::move(entry.control));
  return controls;
}

void set_controls(const V4l2Device& device, const std::vector<std::string>& requests,
                  const std::string& where) {
  if (requests.empty()) return;
  std::vector<Listed> all = query_all(device);
  const std::vector<CameraControl> known = [&] {
    std::vector<CameraControl> controls;
    for (const Listed& entry : all) controls.push_back(entry.control);
    return controls;
  }();
  for (const std::string& text : requests) {
    const ControlRequest request = read_control_request(text, known, where);
    const Listed& entry = all[static_cast<std::size_t>(request.control - known.data())];
    std::int64_t value = request.value;
    const int error = transfer(device, entry.id, entry.wide, true, value);
    if (error == ENODEV) throw DeviceUnready(where, "it went away", "plug it in again");
    if (error != 0) {
      throw DeviceError(where,
                        fmt::format("control {} cannot be set: {}", request.control->name, error_text(error)),
                        "an automatic control may hold it: switch that off before it in the list");
    }
  }
}

}  // namespace sextant
