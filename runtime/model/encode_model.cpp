// SPDX-License-Identifier: Apache-2.0
// Writing side of idl/model/object_model.fbs: in-memory model -> bytes of a model file.
#include <flatbuffers/flatbuffers.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "idl/model/object_model_generated.h"
#include "runtime/base/error.h"
#include "runtime/model/model_check.h"
#include "runtime/model/model_file.h"
#include "runtime/model/quantisation.h"

namespace sextant {
namespace {

using flatbuffers::FlatBufferBuilder;
using flatbuffers::Offset;

constexpr const char* kAdvice = "this is a fault of the program that made the model; compile it again";

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw InputError("model " + name, what, kAdvice);
}

template <typename Part, typename Value>
std::vector<Value> column(const std::vector<Part>& parts, Value (*value_of)(const Part&)) {
  std::vector<Value> values;
  values.reserve(parts.size());
  for (const Part& part : parts) values.push_back(value_of(part));
  return values;
}

/// Refuses steps that round by more than the format promises.
void require_fine(const ObjectModel& model, const QuantisedForms& forms, const RotationBox& box,
                  double limit) {
  const bool storable = std::all_of(forms.exponents.begin(), forms.exponents.end(),
                                    [](int e) { return e <= kMaxStepExponent; });
  const double error = storable ? largest_rounding_error(forms.exponents, box) : HUGE_VAL;
  if (error > limit * rounding_limit_scale(model.bounding_radius_m)) {
    refuse(model.name, "a part's coefficients are too large to be stored in 16 bits");
  }
}

fbs::FormSteps steps_of(const QuantisedForms& forms) {
  const auto e = [&](std::size_t i) { return static_cast<std::int8_t>(forms.exponents[i]); };
  return {e(0), e(1), e(2), e(3)};
}

template <typename Part>
Offset<fbs::PartStatistics> encode_statistics(FlatBufferBuilder& to, const std::vector<Part>& parts) {
  const auto spreads =
      column<Part, std::uint16_t>(parts, [](const Part& p) { return log_code(p.seen.spread); });
  const auto found =
      column<Part, std::uint8_t>(parts, [](const Part& p) { return share_code(p.seen.found); });
  const auto background =
      column<Part, std::uint8_t>(parts, [](const Part& p) { return share_code(p.seen.background); });
  const auto weights =
      column<Part, std::uint16_t>(parts, [](const Part& p) { return log_code(p.seen.weight); });
  return fbs::CreatePartStatisticsDirect(to, &spreads, &found, &background, &weights);
}

Offset<fbs::VisualParts> encode_visual(FlatBufferBuilder& to, const ObjectModel& model,
                                       const ViewpointBin& bin) {
  const auto& parts = bin.visual;
  std::vector<std::array<float, 4>> forms;
  forms.reserve(2 * parts.size());
  for (const VisualPart& part : parts) forms.push_back(part.u);
  for (const VisualPart& part : parts) forms.push_back(part.v);
  const QuantisedForms stored = quantise_forms(forms, bin.box);
  require_fine(model, stored, bin.box, kPositionRoundingLimit);

  const auto kinds = column<VisualPart, std::uint8_t>(parts, [](const VisualPart& p) { return p.kind; });
  const auto variances =
      column<VisualPart, std::uint16_t>(parts, [](const VisualPart& p) { return log_code(p.variance); });
  const auto radii =
      column<VisualPart, std::uint16_t>(parts, [](const VisualPart& p) { return log_code(p.radius); });
  const fbs::FormSteps steps = steps_of(stored);
  const auto seen = encode_statistics(to, parts);
  return fbs::CreateVisualPartsDirect(to, &steps, &kinds, &stored.planes, &variances, &radii, seen);
}

Offset<fbs::DepthParts> encode_depth(FlatBufferBuilder& to, const ObjectModel& model,
                                     const ViewpointBin& bin) {
  const auto& parts = bin.depth;
  std::vector<std::array<float, 4>> forms;
  float farthest = 0;
  for (const DepthPart& part : parts) {
    forms.push_back(part.d);
    farthest = std::max({farthest, std::abs(part.px), std::abs(part.py)});
  }
  const QuantisedForms stored = quantise_forms(forms, bin.box);
  require_fine(model, stored, bin.box, kDepthRoundingLimit);
  const int position_step = step_exponent(farthest);
  if (position_step > kMaxStepExponent ||
      std::ldexp(0.5, position_step) >
          kPositionRoundingLimit * rounding_limit_scale(model.bounding_radius_m)) {
    refuse(model.name, "a depth part lies too far out to be stored in 16 bits");
  }
  std::vector<std::int16_t> positions;
  positions.reserve(2 * parts.size());
  for (const DepthPart& part : parts) positions.push_back(in_steps(part.px, position_step));
  for (const DepthPart& part : parts) positions.push_back(in_steps(part.py, position_step));

  const auto variances =
      column<DepthPart, std::uint16_t>(parts, [](const DepthPart& p) { return log_code(p.variance); });
  const auto radii =
      column<DepthPart, std::uint16_t>(parts, [](const DepthPart& p) { return log_code(p.radius); });
  const auto missing =
      column<DepthPart, std::uint16_t>(parts, [](const DepthPart& p) { return log_code(p.missing); });
  const auto roles = column<DepthPart, std::uint8_t>(
      parts, [](const DepthPart& p) { return static_cast<std::uint8_t>(p.role); });
  const fbs::FormSteps steps = steps_of(stored);
  const auto seen = encode_statistics(to, parts);
  return fbs::CreateDepthPartsDirect(to, static_cast<std::int8_t>(position_step), &positions, &steps,
                                     &stored.planes, &variances, &radii, &missing, seen, &roles);
}

Offset<fbs::Bin> encode_bin(FlatBufferBuilder& to, const ObjectModel& model, const ViewpointBin& bin) {
  const auto visual = encode_visual(to, model, bin);
  const auto depth = encode_depth(to, model, bin);
  std::array<std::int16_t, 3> lo{};
  std::array<std::int16_t, 3> hi{};
  for (std::size_t i = 0; i < 3; ++i) {
    lo[i] = static_cast<std::int16_t>(bin.box.lo_deg[i]);
    hi[i] = static_cast<std::int16_t>(bin.box.hi_deg[i]);
  }
  const fbs::Box box{flatbuffers::span<const std::int16_t, 3>(lo),
                     flatbuffers::span<const std::int16_t, 3>(hi)};
  const fbs::Extent extent(bin.extent[0], bin.extent[1], bin.extent[2], bin.extent[3]);
  return fbs::CreateBin(to, &box, &extent, visual, depth);
}

Offset<fbs::Mesh> encode_mesh(FlatBufferBuilder& to, const ModelMesh& mesh) {
  float farthest = 0;
  for (const Eigen::Vector3f& v : mesh.vertices) farthest = std::max(farthest, v.cwiseAbs().maxCoeff());
  const int step = step_exponent(farthest);
  std::vector<std::int16_t> positions;
  positions.reserve(3 * mesh.vertices.size());
  for (const Eigen::Vector3f& v : mesh.vertices) {
    for (const float c : v) positions.push_back(in_steps(c, step));
  }
  std::vector<std::uint16_t> narrow;
  std::vector<std::uint32_t> wide;
  const bool fits = mesh.vertices.size() <= 65536;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t index : triangle) {
      fits ? narrow.push_back(static_cast<std::uint16_t>(index)) : wide.push_back(index);
    }
  }
  return fbs::CreateMeshDirect(to, static_cast<std::int8_t>(step), &positions, fits ? &narrow : nullptr,
                               fits ? nullptr : &wide);
}

Offset<fbs::Marks> encode_marks(FlatBufferBuilder& to, const std::vector<SurfaceMark>& marks) {
  if (marks.empty()) return 0;
  float farthest = 0;
  for (const SurfaceMark& mark : marks) farthest = std::max(farthest, mark.point.cwiseAbs().maxCoeff());
  const int step = step_exponent(farthest);
  std::vector<std::int16_t> positions;
  std::vector<std::int8_t> directions;
  std::vector<std::int8_t> normals;
  const auto unit = [](float v) {
    return static_cast<std::int8_t>(std::clamp(std::lround(v * 127), -127L, 127L));
  };
  for (const SurfaceMark& mark : marks) {
    for (const float c : mark.point) positions.push_back(in_steps(c, step));
    for (const float c : mark.direction) directions.push_back(unit(c));
    for (const float c : mark.normal) normals.push_back(unit(c));
  }
  return fbs::CreateMarksDirect(to, static_cast<std::int8_t>(step), &positions, &directions, &normals);
}

Offset<fbs::Confidence> encode_confidence(FlatBufferBuilder& to, const ConfidenceModel& confidence) {
  if (!confidence.calibrated) return 0;
  const std::vector<float> weights(confidence.weights.begin(), confidence.weights.end());
  return fbs::CreateConfidenceDirect(to, &weights, &confidence.false_confidences,
                                     static_cast<std::uint32_t>(confidence.images));
}

Offset<fbs::Model> encode_all(FlatBufferBuilder& to, const ObjectModel& model) {
  std::vector<Offset<fbs::Bin>> bins;
  bins.reserve(model.bins.size());
  for (const ViewpointBin& bin : model.bins) bins.push_back(encode_bin(to, model, bin));
  const auto mesh = encode_mesh(to, model.mesh);
  const ModelProvenance& from = model.provenance;
  const auto provenance =
      fbs::CreateProvenanceDirect(to, from.program_version.c_str(), from.mesh_name.c_str(), from.mesh_hash,
                                  from.seed, from.parameters.c_str());
  const auto marks = encode_marks(to, model.marks);
  const auto confidence = encode_confidence(to, model.confidence);
  std::array<double, 9> rotation{};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data()) = model.object_from_mesh.linear();
  std::array<double, 3> translation{};
  Eigen::Map<Eigen::Vector3d>(translation.data()) = model.object_from_mesh.translation();
  const fbs::Transform object_from_mesh{flatbuffers::span<const double, 9>(rotation),
                                        flatbuffers::span<const double, 3>(translation)};
  return fbs::CreateModelDirect(
      to, model.name.c_str(), model.object_id, static_cast<std::int16_t>(model.symmetry_deg),
      static_cast<std::int16_t>(model.geometric_symmetry_deg), model.bounding_radius_m, model.centre_height_m,
      &object_from_mesh, &bins, mesh, provenance, marks, confidence);
}

}  // namespace

std::vector<std::byte> encode_model(const ObjectModel& model) {
  check_model(model, "model " + model.name, kAdvice);
  FlatBufferBuilder builder(1 << 20);
  fbs::FinishModelBuffer(builder, encode_all(builder, model));
  const std::size_t size = builder.GetSize();
  if (size + sizeof(fbs::FileHeader) > kMaxModelFileBytes) {
    throw InputError("model " + model.name, "is larger than 64 MB", "learn it with fewer parts or bins");
  }
  std::uint32_t magic = 0;
  std::memcpy(&magic, fbs::ModelIdentifier(), sizeof magic);
  const fbs::FileHeader header(magic, kModelFormatVersion, size,
                               XXH3_64bits(builder.GetBufferPointer(), size));
  std::vector<std::byte> bytes(sizeof header + size);
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, builder.GetBufferPointer(), size);
  return bytes;
}

}  // namespace sextant
