// SPDX-License-Identifier: Apache-2.0
#include "runtime/model/model_check.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "runtime/base/error.h"
#include "runtime/model/quantisation.h"

namespace sextant {
namespace {

/// Largest coefficient, metres or metres per radian: what 16 bits of the coarsest step hold.
constexpr double kMaxCoefficient = 32767.0 / 512;
/// Constant terms are extrapolated from the bin's centre to angle 0: up to a few turns of the slopes.
constexpr double kMaxConstantTerm = 20 * kMaxCoefficient;

/// Collects the place and the advice, so that each check is one line.
class Checker {
 public:
  Checker(const std::string& where, const std::string& advice) : where_(where), advice_(advice) {}

  void require(bool ok, const char* what) const {
    if (!ok) throw InputError(where_, place_ + what, advice_);
  }
  void at(std::string place) { place_ = std::move(place); }

 private:
  const std::string& where_;
  const std::string& advice_;
  std::string place_;
};

bool within(double value, double lo, double hi) { return std::isfinite(value) && lo <= value && value <= hi; }

bool is_symmetry(int degrees) { return degrees == 0 || degrees == 90 || degrees == 180 || degrees == 360; }

bool form_is_sane(const std::array<float, 4>& form) {
  return within(form[0], -kMaxConstantTerm, kMaxConstantTerm) &&
         std::all_of(form.begin() + 1, form.end(),
                     [](float c) { return within(c, -kMaxCoefficient, kMaxCoefficient); });
}

bool is_positive_log_code(float value) { return within(value, kLogCodeMin, kLogCodeMax); }

void check_text(const Checker& check, const std::string& text, std::size_t longest, bool is_file_name) {
  check.require(text.size() <= longest, "a text is too long");
  check.require(is_printable_utf8(text), "a text holds control characters or is not UTF-8");
  check.require(!is_file_name || text.find('/') == std::string::npos, "a name holds a slash");
}

void check_head(const Checker& check, const ObjectModel& model) {
  check.require(!model.name.empty(), "the model has no name");
  check_text(check, model.name, 200, true);
  check_text(check, model.provenance.program_version, 200, false);
  check_text(check, model.provenance.mesh_name, 255, true);
  check_text(check, model.provenance.parameters, 65536, false);
  check.require(model.object_id >= 0, "the object id is negative");
  check.require(is_symmetry(model.symmetry_deg) && is_symmetry(model.geometric_symmetry_deg),
                "the symmetry is none of 0, 90, 180, 360 degrees");
  check.require(within(model.bounding_radius_m, 1e-6, kMaxObjectRadiusM),
                "the bounding radius is outside 1 um..10 m");
  check.require(within(model.centre_height_m, 0, kMaxObjectRadiusM),
                "the centre's height is outside 0..10 m");
  const Eigen::Matrix3d rotation = model.object_from_mesh.linear();
  const Eigen::Vector3d translation = model.object_from_mesh.translation();
  check.require(rotation.allFinite() && translation.allFinite() && translation.cwiseAbs().maxCoeff() <= 1000,
                "object_from_mesh is not finite or farther than 1 km");
  check.require(
      (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= 1e-6 &&
          rotation.determinant() > 0,
      "object_from_mesh is not a rotation");
}

void check_statistics(const Checker& check, const PartStatistics& seen) {
  check.require(seen.spread == 0 || is_positive_log_code(seen.spread),
                "a part's spread is not a sane number");
  check.require(within(seen.found, 1e-3, 0.999) && within(seen.background, 1e-3, 0.999),
                "a share of found parts is not within 0..1");
  check.require(within(seen.weight, 1e-3, 1e3), "a part's weight is not within 0.001..1000");
}

void check_bin(const Checker& check, const ViewpointBin& bin) {
  for (std::size_t i = 0; i < 3; ++i) {
    check.require(
        bin.box.lo_deg[i] >= -180 && bin.box.hi_deg[i] <= 360 && bin.box.lo_deg[i] < bin.box.hi_deg[i],
        "the box of rotations is empty or outside -180..360 degrees");
  }
  check.require(bin.visual.size() <= kMaxPartsPerKind && bin.depth.size() <= kMaxPartsPerKind,
                "more than 4096 parts");
  check.require(!bin.visual.empty() || !bin.depth.empty(), "no parts");
  const auto& extent = bin.extent;
  check.require(std::all_of(extent.begin(), extent.end(),
                            [](float e) { return within(e, -kMaxObjectRadiusM, kMaxObjectRadiusM); }) &&
                    extent[0] <= extent[2] && extent[1] <= extent[3],
                "the object's extent is not a box");
  for (const VisualPart& part : bin.visual) {
    check.require(part.kind < kFeatureKinds, "a visual part's kind is not 0..7");
    check.require(form_is_sane(part.u) && form_is_sane(part.v),
                  "a visual part's coefficient is not a sane number");
    check.require(is_positive_log_code(part.variance),
                  "a visual part's variance is not a sane positive number");
    check.require(is_positive_log_code(part.radius), "a visual part's radius is not a sane positive number");
    check_statistics(check, part.seen);
  }
  for (const DepthPart& part : bin.depth) {
    check.require(within(part.px, -kMaxCoefficient, kMaxCoefficient) &&
                      within(part.py, -kMaxCoefficient, kMaxCoefficient) && form_is_sane(part.d),
                  "a depth part's coefficient is not a sane number");
    check.require(is_positive_log_code(part.variance),
                  "a depth part's variance is not a sane positive number");
    check.require(is_positive_log_code(part.radius), "a depth part's radius is not a sane positive number");
    check.require(part.missing == 0 || (is_positive_log_code(part.missing) && part.missing <= part.radius),
                  "a depth part's difference for missing depth is not within 0..radius");
    check_statistics(check, part.seen);
    check.require(part.role <= DepthRole::kTable, "a depth part's role is not 0..2");
  }
}

void check_mesh(const Checker& check, const ObjectModel& model) {
  check.require(
      model.mesh.vertices.size() <= kMaxModelVertices && model.mesh.triangles.size() <= kMaxModelTriangles,
      "the mesh is too large");
  // A simplified mesh may stand out of the sphere a little.
  const auto reach = static_cast<float>(2 * model.bounding_radius_m + 1e-3);
  for (const Eigen::Vector3f& vertex : model.mesh.vertices) {
    check.require(vertex.allFinite() && vertex.cwiseAbs().maxCoeff() <= reach,
                  "a vertex is far outside of the bounding sphere");
  }
  for (const auto& triangle : model.mesh.triangles) {
    check.require(*std::max_element(triangle.begin(), triangle.end()) < model.mesh.vertices.size(),
                  "a triangle names a vertex that does not exist");
  }
}

void check_marks(const Checker& check, const ObjectModel& model) {
  check.require(model.marks.size() <= kMaxMarks, "too many marks");
  const auto reach = static_cast<float>(2 * model.bounding_radius_m + 1e-3);
  for (const SurfaceMark& mark : model.marks) {
    check.require(mark.point.allFinite() && mark.point.cwiseAbs().maxCoeff() <= reach,
                  "a mark is far outside of the bounding sphere");
    check.require(within(mark.direction.norm(), 0.9, 1.1) && within(mark.normal.norm(), 0.9, 1.1),
                  "a direction is not of unit length");
  }
}

void check_confidence(const Checker& check, const ConfidenceModel& confidence) {
  check.require(std::all_of(confidence.weights.begin(), confidence.weights.end(),
                            [](float w) { return within(w, -1000, 1000); }),
                "a weight is not a sane number");
  const auto& wrong = confidence.false_confidences;
  check.require(wrong.size() <= kMaxFalseConfidences && confidence.images >= 0 &&
                    wrong.size() <= static_cast<std::size_t>(confidence.images),
                "more false detections than images");
  check.require(std::all_of(wrong.begin(), wrong.end(), [](float c) { return within(c, 0, 1); }) &&
                    std::is_sorted(wrong.rbegin(), wrong.rend()),
                "the confidences of false detections are not falling numbers of 0..1");
}

}  // namespace

void check_model(const ObjectModel& model, const std::string& where, const std::string& advice) {
  Checker check(where, advice);
  check_head(check, model);
  check.require(!model.bins.empty() && model.bins.size() <= kMaxModelBins,
                "the number of bins is not 1..5000");
  for (std::size_t i = 0; i < model.bins.size(); ++i) {
    check.at("bin " + std::to_string(i) + ": ");
    check_bin(check, model.bins[i]);
  }
  check.at("mesh: ");
  check_mesh(check, model);
  check.at("marks: ");
  check_marks(check, model);
  check.at("confidence: ");
  check_confidence(check, model.confidence);
}

bool is_printable_utf8(const std::string& text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t more = lead < 0x80 ? 0 : lead >= 0xf0 ? 3 : lead >= 0xe0 ? 2 : 1;
    if (lead >= 0x80 && (lead < 0xc2 || lead > 0xf4)) return false;
    if (i + more >= text.size()) return false;
    std::uint32_t code = more == 0 ? lead : lead & (0x3fU >> more);
    for (std::size_t k = 1; k <= more; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xc0U) != 0x80) return false;
      code = (code << 6U) | (next & 0x3fU);
    }
    const bool overlong = (more == 2 && code < 0x800) || (more == 3 && code < 0x10000);
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    const bool control = code < 0x20 || (code >= 0x7f && code <= 0x9f) || code == 0x2028 || code == 0x2029;
    // Marks that reorder text could make a report read as what it is not.
    const bool reorders = (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
    if (overlong || surrogate || control || reorders || code > 0x10ffff) return false;
    i += more + 1;
  }
  return true;
}

}  // namespace sextant
