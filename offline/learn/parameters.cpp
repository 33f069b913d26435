// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/parameters.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "runtime/base/error.h"

namespace sextant {
namespace {

/// One parameter: where it lives, its name and its range. Reading, checking and writing derive from this.
struct Field {
  const char* name;
  double low, high;
  std::function<double(const LearnParameters&)> get;
  std::function<void(LearnParameters&, double)> set;
  bool whole;
};

template <typename T>
Field field(const char* name, T LearnParameters::*member, double low, double high) {
  return {name,
          low,
          high,
          [member](const LearnParameters& p) { return static_cast<double>(p.*member); },
          [member](LearnParameters& p, double v) { p.*member = static_cast<T>(v); },
          std::is_integral_v<T>};
}
template <typename T>
Field camera_field(const char* name, T PinholeCamera::*member, double low, double high) {
  return {name,
          low,
          high,
          [member](const LearnParameters& p) { return static_cast<double>(p.camera.*member); },
          [member](LearnParameters& p, double v) { p.camera.*member = static_cast<T>(v); },
          std::is_integral_v<T>};
}

const std::vector<Field>& fields() {
  using P = LearnParameters;
  static const std::vector<Field> kFields{
      field("images_per_bin", &P::images_per_bin, 10, 10000),
      field("visual_parts", &P::visual_parts, 0, 1000),
      field("visual_candidates", &P::visual_candidates, 0, 1000),
      field("depth_parts", &P::depth_parts, 0, 1000),
      field("learn_table", &P::learn_table, 0, 1),
      field("all_orientations", &P::all_orientations, 0, 1),
      field("turn_width_deg", &P::turn_width_deg, 5, 45),
      field("scenes_per_bin", &P::scenes_per_bin, 0, 10000),
      field("visual_radius_px", &P::visual_radius_px, 0.5, 50),
      field("depth_radius_m", &P::depth_radius_m, 0.0005, 0.5),
      field("missing_depth_m", &P::missing_depth_m, 0, 0.5),
      field("visual_max_variance_px2", &P::visual_max_variance_px2, 0.01, 1e6),
      field("depth_max_variance_m2", &P::depth_max_variance_m2, 1e-8, 10),
      field("bin_width_deg", &P::bin_width_deg, 5, 45),
      field("grid", &P::grid, 16, 512),
      field("edge_low", &P::edge_low, 1, 4000),
      field("edge_high", &P::edge_high, 1, 4000),
      field("ambient", &P::ambient, 0, 1),
      field("min_distance_m", &P::min_distance_m, 0.1, 20),
      field("max_distance_m", &P::max_distance_m, 0.1, 20),
      field("min_pitch_deg", &P::min_pitch_deg, -60, 90),
      field("max_pitch_deg", &P::max_pitch_deg, -60, 90),
      field("max_roll_deg", &P::max_roll_deg, 0, 45),
      field("angle_tolerance_deg", &P::angle_tolerance_deg, 0, 45),
      camera_field("camera_width", &PinholeCamera::width, 64, 8192),
      camera_field("camera_height", &PinholeCamera::height, 64, 8192),
      camera_field("camera_focal", &PinholeCamera::focal, 20, 20000),
      camera_field("camera_cx", &PinholeCamera::cx, -8192, 16384),
      camera_field("camera_cy", &PinholeCamera::cy, -8192, 16384),
  };
  return kFields;
}

}  // namespace

void LearnParameters::check() const {
  for (const Field& f : fields()) {
    const double v = f.get(*this);
    if (!(v >= f.low && v <= f.high)) {
      throw UsageError(fmt::format("learning parameter {} is {}, outside {}..{}", f.name, v, f.low, f.high));
    }
  }
  if (visual_parts + depth_parts == 0) throw UsageError("a model needs visual_parts or depth_parts");
  if (missing_depth_m > depth_radius_m) throw UsageError("missing_depth_m must not exceed depth_radius_m");
  if (edge_low > edge_high) throw UsageError("edge_low must not exceed edge_high");
  if (min_distance_m > max_distance_m) throw UsageError("min_distance_m must not exceed max_distance_m");
  if (min_pitch_deg > max_pitch_deg) throw UsageError("the pitch range is empty", "give --pitch-deg MIN:MAX");
}

std::string LearnParameters::to_yaml() const {
  std::string out = "{";
  for (const Field& f : fields()) out += fmt::format("{}: {}, ", f.name, f.get(*this));
  return out + fmt::format("seed: {}}}", seed);
}

void set_learn_parameter(LearnParameters& parameters, const std::string& name, double value) {
  for (const Field& f : fields()) {
    if (name != f.name) continue;
    if (!(value >= f.low && value <= f.high) || (f.whole && value != std::floor(value))) {
      throw UsageError(fmt::format("{} = {}: must be {} {}..{}", name, value,
                                   f.whole ? "a whole number" : "a number", f.low, f.high));
    }
    f.set(parameters, value);
    return;
  }
  throw UsageError("unknown parameter \"" + name + "\"", "see docs/convert-your-object.md");
}

LearnParameters read_learn_parameters(const std::filesystem::path& file) {
  LearnParameters p;
  try {
    const YAML::Node root = YAML::LoadFile(file.string());
    if (!root.IsMap())
      throw InputError(file.string(), "not a mapping of parameters", "write lines like \"grid: 96\"");
    for (const auto& entry : root) {
      const auto name = entry.first.as<std::string>();
      const std::string where = fmt::format("{}:{}", file.string(), entry.first.Mark().line + 1);
      if (name == "seed") {
        p.seed = entry.second.as<std::uint64_t>();
        continue;
      }
      bool known = false;
      for (const Field& f : fields()) {
        if (name != f.name) continue;
        known = true;
        const double v = entry.second.as<double>();
        if (!(v >= f.low && v <= f.high) || (f.whole && v != std::floor(v))) {
          throw InputError(where, fmt::format("{} must be {} {}..{}", name,
                                              f.whole ? "a whole number" : "a number", f.low, f.high));
        }
        f.set(p, v);
      }
      if (!known)
        throw InputError(where, "unknown parameter \"" + name + "\"", "see docs/convert-your-object.md");
    }
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}:{}", file.string(), e.mark.line + 1), e.msg, "fix the YAML");
  }
  p.check();
  return p;
}

}  // namespace sextant
