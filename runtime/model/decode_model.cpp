// SPDX-License-Identifier: Apache-2.0
// Reading side of idl/model/object_model.fbs. Nothing is believed before it was checked: header, checksum,
// FlatBuffers structure, sizes of arrays against each other, and at last the ranges of all values.
#include <flatbuffers/flatbuffers.h>
#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "idl/model/object_model_generated.h"
#include "runtime/base/error.h"
#include "runtime/model/model_check.h"
#include "runtime/model/model_file.h"
#include "runtime/model/quantisation.h"

namespace sextant {
namespace {

constexpr const char* kDamaged = "copy the file again, or compile the mesh again with this version";
constexpr const char* kNotOurs = "give a file that `sextant compile` of this version made";
constexpr flatbuffers::uoffset_t kMaxDepth = 8;
// A bin is five tables; model, mesh, provenance, marks and confidence five more.
constexpr flatbuffers::uoffset_t kMaxTables = 5 * kMaxModelBins + 16;

/// Believes the header as far as it can be checked without the payload.
fbs::FileHeader read_header(std::span<const std::byte> bytes, const std::string& where) {
  fbs::FileHeader header;
  if (bytes.size() < sizeof header || bytes.size() > kMaxModelFileBytes) {
    throw InputError(where,
                     "has " + std::to_string(bytes.size()) + " bytes, which is no size of a model file",
                     bytes.size() < sizeof header ? kDamaged : kNotOurs);
  }
  if (std::memcmp(bytes.data(), fbs::ModelIdentifier(), 4) != 0) {
    throw InputError(where, "is not a compiled model", kNotOurs);
  }
  std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

/// Decodes one verified FlatBuffer.
class Decoder {
 public:
  Decoder(const std::string& where, std::size_t payload_bytes)
      : where_(where), payload_bytes_(payload_bytes) {}

  ObjectModel decode(const fbs::Model& from) {
    ObjectModel model;
    model.name = from.name()->str();
    model.object_id = from.object_id();
    model.symmetry_deg = from.symmetry_deg();
    model.geometric_symmetry_deg = from.geometric_symmetry_deg();
    model.bounding_radius_m = from.bounding_radius_m();
    model.centre_height_m = from.centre_height_m();
    limit_scale_ = rounding_limit_scale(model.bounding_radius_m);
    for (flatbuffers::uoffset_t i = 0; i < 9; ++i) {
      model.object_from_mesh.linear()(i / 3, i % 3) = from.object_from_mesh()->rotation()->Get(i);
    }
    for (flatbuffers::uoffset_t i = 0; i < 3; ++i) {
      model.object_from_mesh.translation()(i) = from.object_from_mesh()->translation()->Get(i);
    }
    require(from.bins()->size() <= kMaxModelBins, "more than 5000 bins");
    model.bins.reserve(from.bins()->size());
    for (const fbs::Bin* bin : *from.bins()) model.bins.push_back(decode_bin(*bin));
    model.mesh = decode_mesh(*from.mesh());
    model.provenance = {from.provenance()->program_version()->str(), from.provenance()->mesh_name()->str(),
                        from.provenance()->mesh_hash(), from.provenance()->seed(),
                        from.provenance()->parameters()->str()};
    if (from.marks() != nullptr) model.marks = decode_marks(*from.marks());
    if (from.confidence() != nullptr) model.confidence = decode_confidence(*from.confidence());
    return model;
  }

 private:
  void require(bool ok, const char* what) const {
    if (!ok) throw InputError(where_, what, kDamaged);
  }

  /// An array that must have `count` numbers. Each array of a sound file has bytes of its own; without this a
  /// small hostile file could name the same array thousands of times and fill the memory.
  template <typename T>
  std::span<const T> array(const flatbuffers::Vector<T>& from, std::size_t count) {
    require(from.size() == count, "an array's size does not fit its part count");
    used_bytes_ += count * sizeof(T);
    require(used_bytes_ <= payload_bytes_, "arrays overlap");
    return {from.data(), count};
  }

  /// int16 in -32767..32767: encode never writes -32768.
  std::span<const std::int16_t> steps_array(const flatbuffers::Vector<std::int16_t>& from,
                                            std::size_t count) {
    const auto values = array(from, count);
    require(std::find(values.begin(), values.end(), INT16_MIN) == values.end(), "a number is out of range");
    return values;
  }

  int checked_step(int exponent) const {
    require(exponent >= kMinStepExponent && exponent <= kMaxStepExponent, "a step is out of range");
    return exponent;
  }

  std::vector<std::array<float, 4>> decode_forms(const fbs::FormSteps& steps,
                                                 std::span<const std::int16_t> planes, const RotationBox& box,
                                                 double rounding_limit) {
    const std::array<int, 4> exponents{checked_step(steps.centre()), checked_step(steps.rx()),
                                       checked_step(steps.ry()), checked_step(steps.rz())};
    require(largest_rounding_error(exponents, box) <= rounding_limit * limit_scale_ &&
                centre_step_is_sound(exponents, planes, box),
            "a step is not one that this format allows");
    return restore_forms(exponents, planes, box);
  }

  ViewpointBin decode_bin(const fbs::Bin& from) {
    ViewpointBin bin;
    for (flatbuffers::uoffset_t i = 0; i < 3; ++i) {
      bin.box.lo_deg[i] = from.box()->lo_deg()->Get(i);
      bin.box.hi_deg[i] = from.box()->hi_deg()->Get(i);
    }
    const fbs::Extent& extent = *from.extent();
    bin.extent = {extent.min_u(), extent.min_v(), extent.max_u(), extent.max_v()};
    decode_visual(*from.visual(), bin);
    decode_depth(*from.depth(), bin);
    return bin;
  }

  void decode_visual(const fbs::VisualParts& from, ViewpointBin& bin) {
    const std::size_t n = from.kind()->size();
    require(n <= kMaxPartsPerKind, "more than 4096 visual parts in a bin");
    const auto kinds = array(*from.kind(), n);
    const auto variances = array(*from.variance(), n);
    const auto radii = array(*from.radius(), n);
    const auto forms =
        decode_forms(*from.steps(), steps_array(*from.forms(), 8 * n), bin.box, kPositionRoundingLimit);
    const auto seen = decode_statistics(*from.seen(), n);
    bin.visual.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      bin.visual[k] = {kinds[k], forms[k], forms[n + k], from_log_code(variances[k]), from_log_code(radii[k]),
                       seen[k]};
    }
  }

  void decode_depth(const fbs::DepthParts& from, ViewpointBin& bin) {
    const std::size_t n = from.variance()->size();
    require(n <= kMaxPartsPerKind, "more than 4096 depth parts in a bin");
    const auto variances = array(*from.variance(), n);
    const auto radii = array(*from.radius(), n);
    const auto missing = array(*from.missing(), n);
    const auto positions = steps_array(*from.positions(), 2 * n);
    const int step = checked_step(from.position_step());
    require(std::ldexp(0.5, step) <= kPositionRoundingLimit * limit_scale_,
            "a step is not one that this format allows");
    const auto forms =
        decode_forms(*from.steps(), steps_array(*from.forms(), 4 * n), bin.box, kDepthRoundingLimit);
    const auto seen = decode_statistics(*from.seen(), n);
    const auto roles = array(*from.role(), n);
    bin.depth.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
      bin.depth[k] = {metres(positions[k], step),
                      metres(positions[n + k], step),
                      forms[k],
                      from_log_code(variances[k]),
                      from_log_code(radii[k]),
                      from_log_code(missing[k]),
                      seen[k],
                      static_cast<DepthRole>(roles[k])};
    }
  }

  std::vector<PartStatistics> decode_statistics(const fbs::PartStatistics& from, std::size_t n) {
    const auto spreads = array(*from.spread(), n);
    const auto found = array(*from.found(), n);
    const auto background = array(*from.background(), n);
    const auto weights = array(*from.weight(), n);
    std::vector<PartStatistics> seen(n);
    for (std::size_t k = 0; k < n; ++k) {
      seen[k] = {from_log_code(spreads[k]), from_share_code(found[k]), from_share_code(background[k]),
                 from_log_code(weights[k])};
    }
    return seen;
  }

  ModelMesh decode_mesh(const fbs::Mesh& from) {
    ModelMesh mesh;
    const std::size_t numbers = from.positions()->size();
    require(numbers % 3 == 0 && numbers / 3 <= kMaxModelVertices,
            "the mesh's vertices are not whole or too many");
    const auto positions = steps_array(*from.positions(), numbers);
    const int step = checked_step(from.position_step());
    mesh.vertices.resize(numbers / 3);
    for (std::size_t i = 0; i < numbers; ++i) {
      mesh.vertices[i / 3](static_cast<Eigen::Index>(i % 3)) = metres(positions[i], step);
    }
    const bool narrow = mesh.vertices.size() <= 65536;
    require((from.triangles16() != nullptr) == narrow && (from.triangles32() != nullptr) == !narrow,
            "the mesh's triangles are not of the right width");
    if (narrow) {
      decode_triangles(*from.triangles16(), mesh);
    } else {
      decode_triangles(*from.triangles32(), mesh);
    }
    return mesh;
  }

  template <typename Index>
  void decode_triangles(const flatbuffers::Vector<Index>& from, ModelMesh& mesh) {
    require(from.size() % 3 == 0 && from.size() / 3 <= kMaxModelTriangles,
            "the mesh's triangles are not whole or too many");
    const auto indices = array(from, from.size());
    mesh.triangles.resize(indices.size() / 3);
    for (std::size_t i = 0; i < indices.size(); ++i) mesh.triangles[i / 3][i % 3] = indices[i];
  }

  std::vector<SurfaceMark> decode_marks(const fbs::Marks& from) {
    const std::size_t numbers = from.positions()->size();
    require(numbers % 3 == 0 && numbers / 3 <= kMaxMarks, "the marks are not whole or too many");
    const auto positions = steps_array(*from.positions(), numbers);
    const auto directions = array(*from.directions(), numbers);
    const auto normals = array(*from.normals(), numbers);
    const int step = checked_step(from.position_step());
    std::vector<SurfaceMark> marks(numbers / 3);
    for (std::size_t i = 0; i < numbers; ++i) {
      SurfaceMark& mark = marks[i / 3];
      const auto axis = static_cast<Eigen::Index>(i % 3);
      mark.point(axis) = metres(positions[i], step);
      mark.direction(axis) = static_cast<float>(directions[i]) / 127;
      mark.normal(axis) = static_cast<float>(normals[i]) / 127;
    }
    return marks;
  }

  ConfidenceModel decode_confidence(const fbs::Confidence& from) {
    ConfidenceModel confidence;
    const auto weights = array(*from.weights(), confidence.weights.size());
    std::copy(weights.begin(), weights.end(), confidence.weights.begin());
    require(from.false_confidences()->size() <= kMaxFalseConfidences && from.images() <= INT32_MAX,
            "too many false detections");
    const auto wrong = array(*from.false_confidences(), from.false_confidences()->size());
    confidence.false_confidences.assign(wrong.begin(), wrong.end());
    confidence.images = static_cast<int>(from.images());
    confidence.calibrated = true;
    return confidence;
  }

  static float metres(std::int16_t steps, int exponent) {
    return static_cast<float>(std::ldexp(static_cast<double>(steps), exponent));
  }

  const std::string& where_;
  std::size_t payload_bytes_;
  std::size_t used_bytes_ = 0;
  double limit_scale_ = 1;
};

}  // namespace

std::uint64_t model_hash(std::span<const std::byte> bytes) { return read_header(bytes, "model").checksum(); }

ObjectModel decode_model(std::span<const std::byte> bytes, const std::string& where) {
  const fbs::FileHeader header = read_header(bytes, where);
  if (header.format_version() != kModelFormatVersion) {
    throw InputError(where,
                     "has format version " + std::to_string(header.format_version()) +
                         ", this program reads version " + std::to_string(kModelFormatVersion),
                     "compile the mesh again with this version");
  }
  std::span<const std::byte> payload = bytes.subspan(sizeof header);
  if (header.payload_bytes() != payload.size()) {
    throw InputError(where,
                     "is cut off or has something behind its end (" + std::to_string(header.payload_bytes()) +
                         " bytes announced, " + std::to_string(payload.size()) + " there)",
                     kDamaged);
  }
  if (XXH3_64bits(payload.data(), payload.size()) != header.checksum()) {
    throw InputError(where, "is damaged (its checksum does not fit)", kDamaged);
  }
  // FlatBuffers reads numbers in place: where the caller's bytes are not aligned, a copy is.
  std::vector<std::uint64_t> aligned;
  if (reinterpret_cast<std::uintptr_t>(payload.data()) % alignof(std::uint64_t) != 0) {
    aligned.resize((payload.size() + 7) / 8);
    std::memcpy(aligned.data(), payload.data(), payload.size());
    payload = std::as_bytes(std::span(aligned)).first(payload.size());
  }
  const auto* data = reinterpret_cast<const std::uint8_t*>(payload.data());
  flatbuffers::Verifier verifier(data, payload.size(), kMaxDepth, kMaxTables);
  if (!fbs::VerifyModelBuffer(verifier)) {
    throw InputError(where, "is not a sound model (its structure is broken)", kDamaged);
  }
  ObjectModel model = Decoder(where, payload.size()).decode(*fbs::GetModel(data));
  check_model(model, where, kDamaged);
  return model;
}

}  // namespace sextant
