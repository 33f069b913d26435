// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/single_frame.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "hal/playback/depth_image.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxCameraFileBytes = 64 << 10;
constexpr std::array kKeys{"width",      "height",         "fx",        "fy",       "cx",      "cy",
                           "distortion", "depth_scale_mm", "pitch_deg", "roll_deg", "height_m"};

/// Levenshtein's distance of two short words.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string nearest_key(const std::string& key) {
  return *std::min_element(kKeys.begin(), kKeys.end(), [&](const char* a, const char* b) {
    return edit_distance(key, a) < edit_distance(key, b);
  });
}

class Reader {
 public:
  Reader(const YAML::Node& root, std::string where) : root_(root), where_(std::move(where)) {}

  bool has(const char* key) const { return root_[key].IsDefined(); }

  double number(const char* key, double lo, double hi) const {
    const YAML::Node node = root_[key];
    if (!node.IsDefined()) throw InputError(where_, fmt::format("the key \"{}\" is missing", key));
    return number(node, key, lo, hi);
  }

  double number(const YAML::Node& node, const char* key, double lo, double hi) const {
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !(value >= lo && value <= hi)) {
      throw InputError(place(node), fmt::format("{} must be a number between {} and {}", key, lo, hi));
    }
    return value;
  }

  int integer(const char* key, int lo, int hi) const {
    const double value = number(key, lo, hi);
    if (value != std::floor(value))
      throw InputError(place(root_[key]), fmt::format("{} must be a whole number", key));
    return static_cast<int>(value);
  }

  std::string place(const YAML::Node& node) const {
    return node.Mark().is_null() ? where_ : fmt::format("{}:{}", where_, node.Mark().line + 1);
  }

 private:
  YAML::Node root_;
  std::string where_;
};

void refuse_unknown_keys(const YAML::Node& root, const Reader& reader) {
  for (const auto& item : root) {
    const std::string key = item.first.IsScalar() ? item.first.Scalar().substr(0, 60) : "";
    if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end()) {
      throw InputError(reader.place(item.first), fmt::format("unknown key \"{}\"", key),
                       fmt::format("did you mean {}?", nearest_key(key)));
    }
  }
}

CameraFile interpret(const YAML::Node& root, const std::string& where) {
  if (!root.IsMap())
    throw InputError(where, "must be a list of \"key: value\" lines", "see sextant detect --help");
  const Reader reader(root, where);
  refuse_unknown_keys(root, reader);
  CameraFile result;
  CameraModel& camera = result.camera;
  camera.width = reader.integer("width", 16, kMaxImageSide);
  camera.height = reader.integer("height", 16, kMaxImageSide);
  camera.fx = reader.number("fx", 1e-3, 1e7);
  camera.fy = reader.number("fy", 1e-3, 1e7);
  camera.cx = reader.number("cx", -1e6, 1e6);
  camera.cy = reader.number("cy", -1e6, 1e6);
  if (reader.has("distortion")) {
    const YAML::Node list = root["distortion"];
    if (!list.IsSequence() || list.size() > camera.distortion.size()) {
      throw InputError(reader.place(list),
                       "distortion must be a list of at most 8 numbers [k1, k2, p1, p2, k3, ...]");
    }
    for (std::size_t i = 0; i < list.size(); ++i)
      camera.distortion[i] = reader.number(list[i], "distortion", -100, 100);
  }
  camera.check(where);
  result.depth_scale_mm = reader.number("depth_scale_mm", 1e-6, 1e3);
  if (reader.has("pitch_deg") != reader.has("height_m") ||
      (reader.has("roll_deg") && !reader.has("pitch_deg"))) {
    throw InputError(where, "the camera over the table needs both pitch_deg and height_m",
                     "give both or neither");
  }
  if (reader.has("pitch_deg")) {
    constexpr double kDegree = std::numbers::pi / 180;
    const double roll_deg = reader.has("roll_deg") ? reader.number("roll_deg", -180, 180) : 0.0;
    result.table = TableGeometry::from_pitch_roll(reader.number("pitch_deg", -90, 90) * kDegree,
                                                  roll_deg * kDegree, reader.number("height_m", 1e-3, 100));
  }
  return result;
}

}  // namespace

CameraFile read_camera_file(const fs::path& file) {
  const std::string where = file.string();
  const std::vector<std::byte> bytes = read_file_bytes(file, kMaxCameraFileBytes);
  try {
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return interpret(YAML::Load(text), where);
  } catch (const YAML::Exception& error) {
    throw InputError(error.mark.is_null() ? where : fmt::format("{}:{}", where, error.mark.line + 1),
                     "is not valid YAML (" + error.msg + ")");
  }
}

RgbdFrame load_single_frame(const fs::path& colour, const fs::path& depth, const fs::path& camera_yaml) {
  const CameraFile file = read_camera_file(camera_yaml);
  RgbdFrame frame;
  frame.colour = read_colour_image(colour);
  frame.axial_depth_m = depth_in_metres(read_depth_image(depth), file.depth_scale_mm);
  require_same_size(frame.colour, colour, frame.axial_depth_m, depth);
  if (frame.colour.cols != file.camera.width || frame.colour.rows != file.camera.height) {
    throw InputError(camera_yaml.string(),
                     fmt::format("says {} x {} pixels, but {} has {} x {}", file.camera.width,
                                 file.camera.height, colour.string(), frame.colour.cols, frame.colour.rows),
                     "give the calibration of this image size");
  }
  frame.camera = file.camera;
  frame.table = file.table;
  return frame;
}

}  // namespace sextant
