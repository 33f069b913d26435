// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "offline/proof/fingerprint.h"
#include "offline/proof/plain_tables.h"
#include "offline/proof/split_tree.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

bool same(const std::optional<TableGeometry>& a, const std::optional<TableGeometry>& b) {
  if (a.has_value() != b.has_value()) return false;
  return !a || (a->up_in_camera == b->up_in_camera && a->camera_height_m == b->camera_height_m);
}

std::string region_text(const Region& r) {
  return fmt::format("bin {}, x {}..{}, y {}..{}, distance {}..{} mm, rx {}..{}, ry {}..{}, rz {}..{} deg",
                     r.bin, r.lo[kX], r.hi[kX], r.lo[kY], r.hi[kY], 2 * r.lo[kZ], 2 * r.hi[kZ], r.lo[kRx],
                     r.hi[kRx], r.lo[kRy], r.hi[kRy], r.lo[kRz], r.hi[kRz]);
}

VerifiedObject verify_object(const ObjectProof& claimed, const SearchRecord::Object& object,
                             const ObjectModel& model, const FrameTables& tables, int max_detections,
                             const std::string& where) {
  for (const ScoredPose& f : claimed.found) {
    if (static_cast<std::size_t>(f.pose.bin) >= object.bins.size()) {
      throw InputError(where, fmt::format("{} has no bin {}", model.name, f.pose.bin));
    }
  }
  const SearchProblem problem{object.bins, tables, object.constraint, model.bounding_radius_m};
  SearchOutcome outcome;
  outcome.found = claimed.found;
  outcome.complete = claimed.status != SearchStatus::kBounded;
  outcome.upper_bound = claimed.upper_bound;
  const Claim claim(problem, outcome, max_detections, claimed.threshold);
  VerifiedObject out{model.name, claimed.status, claimed.found.size(), 0, claim.wrong_detections()};
  if (!out.wrong.empty()) return out;
  const TreeCheck check = check_split_tree(problem, claim, claimed.tree);
  if (!check.well_formed) {
    throw InputError(where, fmt::format("the boxes of {} do not cover the space of poses", model.name));
  }
  out.boxes = check.boxes;
  if (check.broken > 0) {
    out.wrong = fmt::format("not established over {} of {} boxes, the first: {}", check.broken, check.boxes,
                            region_text(check.first_broken));
  }
  return out;
}

}  // namespace

std::vector<VerifiedObject> verify_frame(Detector& detector, const Proof& proof,
                                         const FrameProof& frame_proof, const RgbdFrame& frame,
                                         const std::string& where) {
  const std::string hash = frame_fingerprint(frame);
  if (hash != frame_proof.hash) {
    throw InputError(where, fmt::format("scene {} image {} is not the frame of the proof (hash {}, not {})",
                                        frame_proof.scene_id, frame_proof.image_id, hash, frame_proof.hash));
  }
  std::vector<VerifiedObject> out;
  detector.prepare(frame, [&](const SearchRecord& record) {
    if (!same(record.table, frame_proof.table) ||
        record.tolerance.height_m != frame_proof.tolerance.height_m ||
        record.tolerance.angle_rad != frame_proof.tolerance.angle_rad) {
      throw InputError(where, fmt::format("scene {} image {}: the table is not the one of the proof",
                                          frame_proof.scene_id, frame_proof.image_id));
    }
    WorkerPool serial(1);
    FrameTables tables;
    tables.build(record.frame, record.edges, record.clip_radius, serial);
    if (const std::string wrong = wrong_table(tables, record.frame, record.edges); !wrong.empty()) {
      throw std::logic_error(wrong);
    }
    for (const ObjectProof& claimed : frame_proof.objects) {
      const auto object =
          std::find_if(record.objects.begin(), record.objects.end(),
                       [&](const SearchRecord::Object& o) { return o.model_index == claimed.model; });
      if (object == record.objects.end()) throw InputError(where, "a claim is about no model of the proof");
      out.push_back(verify_object(claimed, *object, detector.models()[claimed.model], tables,
                                  proof.options.max_detections, where));
    }
  });
  return out;
}

}  // namespace sextant
