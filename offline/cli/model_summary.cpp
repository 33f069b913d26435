// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/model_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "offline/report/model_sheet/contact_sheet.h"

namespace sextant {
namespace {

/// Square pixels at 1 m with f = 525 in one (tangent * metre)^2: the thesis's unit.
constexpr double kSquarePixels = 525.0 * 525.0;

std::vector<double> visual_variances(const std::vector<const ViewpointBin*>& bins) {
  std::vector<double> values;
  for (const ViewpointBin* bin : bins) {
    for (const VisualPart& part : bin->visual) values.push_back(part.variance * kSquarePixels);
  }
  std::sort(values.begin(), values.end());
  return values;
}

std::vector<double> depth_variances(const std::vector<const ViewpointBin*>& bins) {
  std::vector<double> values;
  for (const ViewpointBin* bin : bins) {
    for (const DepthPart& part : bin->depth) values.push_back(part.variance);
  }
  std::sort(values.begin(), values.end());
  return values;
}

std::vector<const ViewpointBin*> all_bins(const ObjectModel& model) {
  std::vector<const ViewpointBin*> bins;
  for (const ViewpointBin& bin : model.bins) bins.push_back(&bin);
  return bins;
}

/// Smallest box around all bins' boxes.
RotationBox hull(const ObjectModel& model) {
  RotationBox box = model.bins.front().box;
  for (const ViewpointBin& bin : model.bins) {
    for (std::size_t i = 0; i < 3; ++i) {
      box.lo_deg[i] = std::min(box.lo_deg[i], bin.box.lo_deg[i]);
      box.hi_deg[i] = std::max(box.hi_deg[i], bin.box.hi_deg[i]);
    }
  }
  return box;
}

std::string range(const RotationBox& box, std::size_t i) {
  return fmt::format("{}..{}", box.lo_deg[i], box.hi_deg[i]);
}

/// 5 %, 50 %, 95 % of the standard deviations.
std::string deviations(const std::vector<double>& sorted_variances, double unit) {
  if (sorted_variances.empty()) return "-";
  const auto at = [&](double share) { return std::sqrt(quantile(sorted_variances, share)) * unit; };
  return fmt::format("{:.2f} / {:.2f} / {:.2f}", at(0.05), at(0.5), at(0.95));
}

std::string hex(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

nlohmann::ordered_json quantiles(const std::vector<double>& sorted) {
  nlohmann::ordered_json out;
  if (sorted.empty()) return out;
  out["min"] = sorted.front();
  out["p05"] = quantile(sorted, 0.05);
  out["p50"] = quantile(sorted, 0.5);
  out["p95"] = quantile(sorted, 0.95);
  out["max"] = sorted.back();
  return out;
}

nlohmann::ordered_json bin_as_json(const ViewpointBin& bin) {
  nlohmann::ordered_json out;
  const char* const names[] = {"rx_deg", "ry_deg", "rz_deg"};
  for (std::size_t i = 0; i < 3; ++i) out[names[i]] = {bin.box.lo_deg[i], bin.box.hi_deg[i]};
  std::array<int, kFeatureKinds> kinds{};
  for (const VisualPart& part : bin.visual) ++kinds[part.kind];
  out["visual"] = {{"parts", bin.visual.size()},
                   {"parts_per_kind", kinds},
                   {"variance_px2", quantiles(visual_variances({&bin}))}};
  out["depth"] = {{"parts", bin.depth.size()}, {"variance_m2", quantiles(depth_variances({&bin}))}};
  out["extent"] = bin.extent;
  return out;
}

}  // namespace

double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = position - static_cast<double>(below);
  return sorted[below] + part * (sorted[above] - sorted[below]);
}

std::string model_as_text(const ModelFileContent& content, const std::string& file, std::size_t max_bins) {
  const ObjectModel& model = content.model;
  const ModelProvenance& from = model.provenance;
  std::string out;
  const auto line = [&](const char* what, const std::string& value) {
    out += fmt::format("{:<18}{}\n", what, value);
  };
  line("model", fmt::format("{} (object id {}) in {}", model.name, model.object_id, file));
  line("format", fmt::format("version {}, {} bytes, checksum {}", kModelFormatVersion, content.bytes,
                             hex(content.hash)));
  line("made by", fmt::format("{}, seed {}", from.program_version, from.seed));
  line("made from", fmt::format("{} (XXH3 {})", from.mesh_name, hex(from.mesh_hash)));
  line("parameters", from.parameters);
  line("size", fmt::format("bounding radius {:.1f} mm, centre {:.1f} mm above the table",
                           model.bounding_radius_m * 1e3, model.centre_height_m * 1e3));
  line("symmetry", fmt::format("{} deg, of the shape alone {} deg (360 = none, 0 = rotational)",
                               model.symmetry_deg, model.geometric_symmetry_deg));
  const Eigen::Vector3d origin_mm = model.object_from_mesh.translation() * 1e3;
  const Eigen::Vector3d up = model.object_from_mesh.linear().row(2);
  line("mesh frame",
       fmt::format("origin at {:.1f}, {:.1f}, {:.1f} mm from the centre; up is {:.3f}, {:.3f}, {:.3f}",
                   origin_mm.x(), origin_mm.y(), origin_mm.z(), up.x(), up.y(), up.z()));
  line("outline mesh",
       fmt::format("{} vertices, {} triangles", model.mesh.vertices.size(), model.mesh.triangles.size()));
  line("print", fmt::format("{} marks", model.marks.size()));
  line("confidence", model.confidence.calibrated
                         ? fmt::format("calibrated on {} images, a false detection on {} of them",
                                       model.confidence.images, model.confidence.false_confidences.size())
                         : std::string("not calibrated (sextant calibrate): general weights"));
  const std::vector<const ViewpointBin*> bins = all_bins(model);
  const RotationBox box = hull(model);
  line("bins",
       fmt::format("{}: rx {}, ry {}, rz {} deg", bins.size(), range(box, 0), range(box, 1), range(box, 2)));
  const std::vector<double> visual = visual_variances(bins);
  const std::vector<double> depth = depth_variances(bins);
  line("visual parts", fmt::format("{}, standard deviation {} px (5 / 50 / 95 %; at 1 m, f = 525 px)",
                                   visual.size(), deviations(visual, 1)));
  line("depth parts",
       fmt::format("{}, standard deviation {} mm (5 / 50 / 95 %)", depth.size(), deviations(depth, 1e3)));

  const std::vector<std::size_t> listed = bins_of_sheet(bins.size(), max_bins);
  out += fmt::format("\n{:>5}  {:>10}  {:>10}  {:>10}  {:>7}  {:>22}  {:>7}  {:>22}\n", "bin", "rx deg",
                     "ry deg", "rz deg", "visual", "sd px", "depth", "sd mm");
  for (const std::size_t i : listed) {
    const ViewpointBin& bin = model.bins[i];
    out += fmt::format("{:>5}  {:>10}  {:>10}  {:>10}  {:>7}  {:>22}  {:>7}  {:>22}\n", i, range(bin.box, 0),
                       range(bin.box, 1), range(bin.box, 2), bin.visual.size(),
                       deviations(visual_variances({&bin}), 1), bin.depth.size(),
                       deviations(depth_variances({&bin}), 1e3));
  }
  if (listed.size() < bins.size()) {
    out += fmt::format("({} of {} bins; --bins N lists more, --json all)\n", listed.size(), bins.size());
  }
  return out;
}

std::string model_as_json(const ModelFileContent& content, const std::string& file) {
  const ObjectModel& model = content.model;
  nlohmann::ordered_json out;
  out["file"] = file;
  out["name"] = model.name;
  out["object_id"] = model.object_id;
  out["format_version"] = kModelFormatVersion;
  out["bytes"] = content.bytes;
  out["checksum"] = hex(content.hash);
  out["provenance"] = {{"program_version", model.provenance.program_version},
                       {"mesh_name", model.provenance.mesh_name},
                       {"mesh_hash", hex(model.provenance.mesh_hash)},
                       {"seed", model.provenance.seed},
                       {"parameters", model.provenance.parameters}};
  out["symmetry_deg"] = model.symmetry_deg;
  out["geometric_symmetry_deg"] = model.geometric_symmetry_deg;
  out["bounding_radius_m"] = model.bounding_radius_m;
  out["centre_height_m"] = model.centre_height_m;
  out["marks"] = model.marks.size();
  out["calibrated"] = model.confidence.calibrated;
  out["calibration_images"] = model.confidence.images;
  const Eigen::Matrix4d transform = model.object_from_mesh.matrix();
  for (Eigen::Index r = 0; r < 4; ++r) {
    out["object_from_mesh"].push_back({transform(r, 0), transform(r, 1), transform(r, 2), transform(r, 3)});
  }
  out["mesh"] = {{"vertices", model.mesh.vertices.size()}, {"triangles", model.mesh.triangles.size()}};
  const std::vector<const ViewpointBin*> bins = all_bins(model);
  const std::vector<double> visual = visual_variances(bins);
  const std::vector<double> depth = depth_variances(bins);
  out["visual"] = {{"parts", visual.size()}, {"variance_px2", quantiles(visual)}};
  out["depth"] = {{"parts", depth.size()}, {"variance_m2", quantiles(depth)}};
  out["bins"] = nlohmann::ordered_json::array();
  for (const ViewpointBin& bin : model.bins) out["bins"].push_back(bin_as_json(bin));
  // A path may hold any bytes.
  return out.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sextant
