// SPDX-License-Identifier: Apache-2.0
#include "hal/pairing/rig_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxBytes = 64 << 10;

/// A map of the file; every error names file, line and key.
class Section {
 public:
  Section(const YAML::Node& node, std::string name, const std::string& file,
          std::initializer_list<const char*> keys)
      : node_(node), name_(std::move(name)), file_(file) {
    if (!node_.IsMap())
      refuse(node_, (name_.empty() ? "the file" : name_) + " must be a list of \"key: value\"");
    for (const auto& item : node_) {
      const std::string key = item.first.IsScalar() ? item.first.Scalar().substr(0, 60) : "";
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      std::string known;
      for (const char* k : keys) known += (known.empty() ? "" : ", ") + std::string(k);
      refuse(item.first, "unknown key \"" + key + "\"", "known are " + known);
    }
  }

  bool has(const char* key) const { return node_[key].IsDefined(); }
  YAML::Node get(const char* key) const {
    const YAML::Node value = node_[key];
    if (!value.IsDefined()) refuse(node_, label(key) + " is missing");
    return value;
  }
  double number(const char* key, double lo, double hi) const { return number(get(key), key, lo, hi); }
  double number(const char* key, double lo, double hi, double otherwise) const {
    return has(key) ? number(key, lo, hi) : otherwise;
  }
  int integer(const char* key, int lo, int hi) const {
    const double value = number(key, lo, hi);
    if (value != std::floor(value)) refuse(get(key), label(key) + " must be a whole number");
    return static_cast<int>(value);
  }
  bool flag(const char* key) const {
    if (!has(key)) return false;
    bool value = false;
    if (!YAML::convert<bool>::decode(get(key), value))
      refuse(get(key), label(key) + " must be true or false");
    return value;
  }
  std::vector<double> numbers(const char* key, std::size_t least, std::size_t most, double limit) const {
    const YAML::Node list = get(key);
    if (!list.IsSequence() || list.size() < least || list.size() > most) {
      refuse(list,
             fmt::format("{} must be a list of {} numbers", label(key),
                         least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most)));
    }
    std::vector<double> out;
    for (const auto& item : list) out.push_back(number(item, key, -limit, limit));
    return out;
  }
  [[noreturn]] void refuse(const YAML::Node& at, const std::string& what,
                           const std::string& advice = "") const {
    const YAML::Mark mark = at.Mark();
    throw InputError(mark.is_null() ? file_ : fmt::format("{}:{}", file_, mark.line + 1), what, advice);
  }

 private:
  std::string label(const char* key) const { return name_.empty() ? key : name_ + "." + key; }
  double number(const YAML::Node& node, const char* key, double lo, double hi) const {
    double value = 0;
    if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !(value >= lo && value <= hi)) {
      refuse(node, fmt::format("{} must be a number between {} and {}", label(key), lo, hi));
    }
    return value;
  }

  YAML::Node node_;
  std::string name_;
  std::string file_;
};

CameraModel camera_of(const Section& section, const std::string& where) {
  CameraModel c;
  c.width = section.integer("width", 16, kMaxImageSide);
  c.height = section.integer("height", 16, kMaxImageSide);
  c.fx = section.number("fx", 1e-3, 1e7);
  c.fy = section.number("fy", 1e-3, 1e7);
  c.cx = section.number("cx", -1e6, 1e6);
  c.cy = section.number("cy", -1e6, 1e6);
  if (section.has("distortion")) {
    const std::vector<double> d = section.numbers("distortion", 0, c.distortion.size(), 100);
    std::copy(d.begin(), d.end(), c.distortion.begin());
  }
  c.check(where);
  return c;
}

RigidTransform transform_of(const Section& section) {
  RigidTransform t = RigidTransform::Identity();
  const std::vector<double> p = section.numbers("translation_m", 3, 3, 2);
  t.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
  if (!section.has("rotation")) return t;
  const std::vector<double> r = section.numbers("rotation", 9, 9, 2);
  const Eigen::Matrix3d given = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
  if ((given * given.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > 0.02 ||
      given.determinant() < 0) {
    section.refuse(section.get("rotation"), "colour_from_depth.rotation is no rotation matrix");
  }
  // Rounded digits: the nearest rotation.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(given, Eigen::ComputeFullU | Eigen::ComputeFullV);
  t.linear() = svd.matrixU() * svd.matrixV().transpose();
  return t;
}

DepthScale scale_of(const Section& depth) {
  DepthScale scale;
  scale.metres_per_unit = depth.number("metres_per_unit", 1e-6, 1, scale.metres_per_unit);
  scale.nearest_m = depth.number("nearest_m", 0, 100, scale.nearest_m);
  scale.farthest_m = depth.number("farthest_m", 0.01, 100, scale.farthest_m);
  if (depth.has("encoding")) {
    const YAML::Node node = depth.get("encoding");
    const std::string name = node.IsScalar() ? node.Scalar() : "";
    if (name == "kinect") {
      scale.encoding = DepthScale::Encoding::kKinectDisparity;
    } else if (name != "linear") {
      depth.refuse(node, "depth.encoding must be linear or kinect");
    }
  }
  return scale;
}

RigFile interpret(const YAML::Node& root, const std::string& file) {
  RigFile rig;
  const Section top(root, "", file,
                    {"colour", "depth", "colour_from_depth", "tolerance_ms", "shared_sequence"});
  const Section colour(top.get("colour"), "colour", file,
                       {"width", "height", "fx", "fy", "cx", "cy", "distortion"});
  const Section depth(top.get("depth"), "depth", file,
                      {"width", "height", "fx", "fy", "cx", "cy", "distortion", "registered",
                       "metres_per_unit", "nearest_m", "farthest_m", "encoding"});
  rig.calibration.colour = camera_of(colour, file + ": colour");
  rig.calibration.depth_is_registered = depth.flag("registered");
  rig.depth_scale = scale_of(depth);
  if (rig.calibration.depth_is_registered) {
    if (top.has("colour_from_depth")) {
      top.refuse(top.get("colour_from_depth"), "registered depth has no colour_from_depth",
                 "remove one of them");
    }
  } else {
    rig.calibration.depth = camera_of(depth, file + ": depth");
    rig.calibration.colour_from_depth = transform_of(
        Section(top.get("colour_from_depth"), "colour_from_depth", file, {"translation_m", "rotation"}));
  }
  rig.synchroniser.tolerance = std::chrono::nanoseconds(
      std::llround(1e6 * top.number("tolerance_ms", 0, 1000,
                                    1e-6 * static_cast<double>(rig.synchroniser.tolerance.count()))));
  rig.synchroniser.shared_sequence = top.flag("shared_sequence");
  return rig;
}

}  // namespace

RigFile read_rig_file(const std::filesystem::path& file) {
  const std::string where = file.string();
  const std::vector<std::byte> bytes = read_file_bytes(file, kMaxBytes);
  try {
    return interpret(YAML::Load(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size())),
                     where);
  } catch (const YAML::Exception& error) {
    throw InputError(error.mark.is_null() ? where : fmt::format("{}:{}", where, error.mark.line + 1),
                     "is not valid YAML (" + error.msg + ")");
  }
}

}  // namespace sextant
