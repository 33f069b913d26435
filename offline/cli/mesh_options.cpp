// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/mesh_options.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "runtime/base/error.h"

namespace sextant {
namespace {

int whole_number(const std::string& text, const std::string& option) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw UsageError(option + " " + text + " is neither auto nor a whole number");
  }
  return value;
}

constexpr double kLeastProbability = 0.05;

}  // namespace

void MeshArguments::add_to(CLI::App& command) {
  command.add_option("--units", units, "length unit of the mesh")
      ->check(CLI::IsMember({"m", "cm", "mm", "in"}))
      ->capture_default_str();
  command.add_option("--up", up, "axis of the mesh that points up when the object stands; overrides --rest")
      ->check(CLI::IsMember({"x", "y", "z", "-x", "-y", "-z"}));
  command
      .add_option(
          "--rest", rest,
          "stable resting pose: auto lists them and takes the most likely, N takes the Nth (from 0); compile "
          "also takes 0,2 and all (of 5 % or more): a model for each")
      ->capture_default_str();
  command
      .add_option("--symmetry-deg", symmetry,
                  "rotation about the vertical after which the object looks the same")
      ->check(CLI::IsMember({"auto", "0", "90", "180", "360"}))
      ->capture_default_str();
}

MeshOptions MeshArguments::options() const {
  static const std::map<std::string, double> kUnits{{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}};
  MeshOptions out;
  out.metres_per_unit = kUnits.at(units);
  out.up = up;
  if (several()) throw UsageError("--rest " + rest + ": one resting pose at a time here");
  if (rest != "auto") out.rest = whole_number(rest, "--rest");
  if (symmetry != "auto") out.symmetry_deg = whole_number(symmetry, "--symmetry-deg");
  return out;
}

std::vector<int> MeshArguments::rests(const std::vector<RestingPose>& poses) const {
  std::vector<int> out;
  if (rest == "all") {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (poses[i].probability >= kLeastProbability) out.push_back(static_cast<int>(i));
    }
    return out;
  }
  for (std::size_t from = 0; from <= rest.size();) {
    const std::size_t comma = std::min(rest.find(',', from), rest.size());
    out.push_back(whole_number(rest.substr(from, comma - from), "--rest"));
    from = comma + 1;
  }
  if (std::set<int>(out.begin(), out.end()).size() != out.size()) {
    throw UsageError("--rest " + rest + " names a resting pose twice");
  }
  return out;
}

}  // namespace sextant
