// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/proof_writer.h"

#include <stdexcept>

#include "offline/proof/fingerprint.h"
#include "offline/proof/split_tree.h"
#include "runtime/base/version.h"

namespace sextant {

ProofWriter::ProofWriter(const std::vector<std::filesystem::path>& model_files,
                         const std::vector<ObjectModel>& models, const DetectOptions& options,
                         FrameSourceProof source) {
  proof_.program = std::string("sextant ") + kProgramVersion;
  for (std::size_t i = 0; i < models.size(); ++i) {
    proof_.models.push_back({model_files[i].string(), file_fingerprint(model_files[i]), models[i].name});
    bounding_radii_m_.push_back(models[i].bounding_radius_m);
  }
  proof_.source = std::move(source);
  proof_.options = options;
}

void ProofWriter::add(const RgbdFrame& frame, const SearchRecord& record) {
  FrameProof out;
  out.scene_id = frame.scene_id;
  out.image_id = frame.image_id;
  out.hash = frame_fingerprint(frame);
  out.table = record.table;
  out.tolerance = record.tolerance;
  tables_.build(record.frame, record.edges, record.clip_radius, serial_);
  for (const SearchRecord::Object& object : record.objects) {
    const SearchOutcome& outcome = object.outcome;
    const SearchProblem problem{object.bins, tables_, object.constraint,
                                bounding_radii_m_[object.model_index]};
    const Claim claim(problem, outcome, proof_.options.max_detections, object.threshold);
    if (const std::string wrong = claim.wrong_detections(); !wrong.empty()) throw std::logic_error(wrong);
    ObjectProof o;
    o.model = object.model_index;
    o.threshold = object.threshold;
    o.status = !outcome.complete       ? SearchStatus::kBounded
               : outcome.found.empty() ? SearchStatus::kAbsent
                                       : SearchStatus::kOptimal;
    o.upper_bound = outcome.upper_bound;
    o.found = outcome.found;
    o.tree = grow_split_tree(problem, claim);
    out.objects.push_back(std::move(o));
  }
  proof_.frames.push_back(std::move(out));
}

}  // namespace sextant
