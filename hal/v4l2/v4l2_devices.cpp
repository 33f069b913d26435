// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/v4l2_devices.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>

#include "hal/live/stream_session.h"
#include "hal/v4l2/v4l2_controls.h"
#include "hal/v4l2/v4l2_modes.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

/// N of videoN, or -1.
int node_number(const std::string& name) {
  int number = -1;
  if (name.rfind("video", 0) != 0) return -1;
  const auto [end, error] = std::from_chars(name.data() + 5, name.data() + name.size(), number);
  return error == std::errc() && end == name.data() + name.size() ? number : -1;
}

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line.substr(0, 200);
}

/// The USB serial number: of the nearest ancestor that has one. Devices without show nothing.
std::string serial_of(const fs::path& sys_node) {
  std::error_code error;
  fs::path folder = fs::canonical(sys_node / "device", error);
  for (int level = 0; !error && level < 4 && folder.has_relative_path(); ++level) {
    if (fs::exists(folder / "idVendor", error)) return first_line(folder / "serial");
    folder = folder.parent_path();
  }
  return {};
}

/// udev's names that lead to each node.
std::multimap<std::string, fs::path> links_to_nodes(const fs::path& folder) {
  std::multimap<std::string, fs::path> links;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path target = fs::canonical(entry.path(), error);
    if (!error) links.emplace(target.string(), entry.path());
  }
  return links;
}

template <std::size_t N>
std::string text_of(const std::uint8_t (&field)[N]) {
  const auto* begin = reinterpret_cast<const char*>(field);
  return {begin, std::find(begin, begin + N, '\0')};
}

void describe(const V4l2Device& opened, bool details, CameraDevice& device) {
  device.name = text_of(opened.description().card);
  device.driver = text_of(opened.description().driver);
  device.bus = text_of(opened.description().bus_info);
  if (!details) return;
  device.modes = list_modes(opened);
  device.controls = list_controls(opened);
}

/// "" for the first node of a device, "#1" for the second.
std::string ordinal(std::map<std::string, int>& seen, const std::string& key) {
  const int number = seen[key]++;
  return number == 0 ? "" : fmt::format("#{}", number);
}

bool has_id(const CameraDevice& device, const std::string& id) {
  return device.id == id ||
         std::find(device.aliases.begin(), device.aliases.end(), id) != device.aliases.end();
}

std::string what_there_is(const std::vector<CameraDevice>& devices) {
  if (devices.empty()) return "there are no V4L2 cameras; is it plugged in?";
  std::string text;
  for (const CameraDevice& device : devices) text += (text.empty() ? "" : ", ") + device.id;
  return "there are " + text;
}

}  // namespace

std::vector<CameraDevice> list_v4l2_devices(bool details, const DevicePlaces& places) {
  std::vector<std::pair<int, std::string>> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(places.sys / "class/video4linux", error)) {
    const std::string name = entry.path().filename().string();
    if (const int number = node_number(name); number >= 0) names.emplace_back(number, name);
  }
  std::sort(names.begin(), names.end());
  const auto by_id = links_to_nodes(places.dev / "v4l/by-id");
  const auto by_path = links_to_nodes(places.dev / "v4l/by-path");
  std::map<std::string, int> seen;
  std::vector<CameraDevice> devices;
  for (const auto& [number, name] : names) {
    CameraDevice device;
    device.kind = "v4l2";
    device.node = (places.dev / name).string();
    const fs::path sys_node = places.sys / "class/video4linux" / name;
    device.serial = serial_of(sys_node);
    try {
      const V4l2Device opened(device.node);
      if (opened.capture_type() == 0) continue;  // an output, radio, metadata, codec
      describe(opened, details, device);
    } catch (const DeviceError& failure) {
      device.name = first_line(sys_node / "name");
      device.problem = failure.what();
    }
    for (auto [link, end] = by_id.equal_range(device.node); link != end; ++link) {
      device.aliases.push_back(link->second.filename().string());
      device.aliases.push_back(link->second.string());
    }
    if (!device.serial.empty()) {
      const std::string key = "serial:" + device.serial;
      device.aliases.push_back(key + ordinal(seen, key));
    }
    if (!device.bus.empty()) {
      const std::string key = "bus:" + device.bus;
      device.aliases.push_back(key + ordinal(seen, key));
    }
    for (auto [link, end] = by_path.equal_range(device.node); link != end; ++link)
      device.aliases.push_back(link->second.string());
    device.aliases.push_back(device.node);
    device.id = device.aliases.front();
    device.aliases.erase(device.aliases.begin());
    devices.push_back(std::move(device));
  }
  return devices;
}

std::shared_ptr<V4l2Device> open_v4l2_device(const std::string& id, const DevicePlaces& places) {
  if (id.empty())
    throw DeviceError("v4l2", "no device is named", what_there_is(list_v4l2_devices(false, places)));
  std::shared_ptr<V4l2Device> opened;
  if (id.front() == '/') {
    opened = std::make_shared<V4l2Device>(id);
  } else {
    const std::string wanted = id.size() > 2 && id.ends_with("#0") ? id.substr(0, id.size() - 2) : id;
    const std::vector<CameraDevice> devices = list_v4l2_devices(false, places);
    const auto found = std::find_if(devices.begin(), devices.end(),
                                    [&](const CameraDevice& d) { return has_id(d, wanted); });
    if (found == devices.end())
      throw DeviceUnready(id, "there is no such V4L2 camera", what_there_is(devices));
    if (std::any_of(found + 1, devices.end(), [&](const CameraDevice& d) { return has_id(d, wanted); }))
      throw DeviceError(id, "two cameras have this name", what_there_is(devices));
    opened = std::make_shared<V4l2Device>(found->node);
  }
  if (opened->capture_type() == 0)
    throw DeviceError(id, "this is no camera that streams", what_there_is(list_v4l2_devices(false, places)));
  return opened;
}

}  // namespace sextant
