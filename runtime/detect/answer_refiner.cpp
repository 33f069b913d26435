// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/answer_refiner.h"

#include <algorithm>
#include <atomic>

#include "runtime/detect/outline_box.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/refine/confidence.h"
#include "runtime/search/other_turns.h"

namespace sextant {
namespace {

/// Share of the evidence by which another turn may score less and still be tried.
constexpr double kNearlyAsGood = 0.1;
constexpr std::size_t kMostOtherTurns = 3;
/// Share of the pixels in which two turns differ that another turn must explain better.
constexpr double kClearlyBetter = 0.1;

}  // namespace

AnswerRefiner::AnswerRefiner(const std::vector<ObjectModel>& models, WorkerPool& pool)
    : models_(models), pool_(pool) {}

Refiner& AnswerRefiner::refiner(std::size_t model, std::size_t slot) {
  std::unique_ptr<Refiner>& mine = refiners_[model][slot];
  if (!mine) mine = std::make_unique<Refiner>(models_[model]);
  return *mine;
}

void AnswerRefiner::refine(const RefineFrame& seen, const CameraModel& camera, const FrameTables& tables,
                           std::span<const FoundPose> found, std::span<PoseEstimate> answers) {
  refiners_.resize(models_.size());
  for (auto& of_model : refiners_) of_model.resize(static_cast<std::size_t>(pool_.threads()));
  const std::vector<PoseEstimate> lattice(answers.begin(), answers.end());
  std::vector<std::vector<PoseEstimate>> turned(answers.size());
  for_each_with_slot(2 * answers.size(), [&](std::size_t item, std::size_t slot) {
    const std::size_t i = item / 2;
    if (item % 2 == 0) {
      turned[i] = turned_otherwise(tables, lattice[i], found[i]);
    } else {
      refine_one(seen, camera, slot, answers[i]);
    }
  });
  std::vector<PoseEstimate*> others;
  for (std::vector<PoseEstimate>& of_one : turned) {
    for (PoseEstimate& other : of_one) others.push_back(&other);
  }
  for_each_with_slot(others.size(), [&](std::size_t item, std::size_t slot) {
    refine_one(seen, camera, slot, *others[item]);
  });
  for_each_with_slot(answers.size(), [&](std::size_t i, std::size_t slot) {
    for (PoseEstimate& other : turned[i]) choose_turn(seen, slot, other, answers[i]);
  });
}

/// Calls work(item, slot) for every item; no two at once have the same slot (0..threads - 1).
void AnswerRefiner::for_each_with_slot(std::size_t items,
                                       const std::function<void(std::size_t, std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  pool_.for_each(static_cast<std::size_t>(pool_.threads()), [&](std::size_t slot) {
    for (std::size_t item = next++; item < items; item = next++) work(item, slot);
  });
}

/// Replaces a lattice pose by the continuous one.
void AnswerRefiner::refine_one(const RefineFrame& seen, const CameraModel& camera, std::size_t slot,
                               PoseEstimate& answer) {
  const ObjectModel& model = models_[answer.model_index];
  const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
  const RefinedPose refined =
      refiner(answer.model_index, slot).refine(seen, answer.camera_from_object * mesh_from_object);
  answer.camera_from_object = refined.camera_from_object * model.object_from_mesh;
  const Eigen::Vector3d offset =
      answer.camera_from_object.translation() - refined.camera_from_object.translation();
  answer.covariance = moved_covariance(with_model_error(refined.covariance), offset);
  answer.refinement = refined.quality;
  answer.score = confidence(model.confidence, confidence_features(answer));
  answer.bbox = outline_box(model, camera, refined.camera_from_object);
}

/// The other turns of what was found that score nearly as well, at their lattice poses.
std::vector<PoseEstimate> AnswerRefiner::turned_otherwise(const FrameTables& tables,
                                                          const PoseEstimate& answer,
                                                          const FoundPose& found) const {
  const ObjectModel& model = models_[answer.model_index];
  const std::vector<ScoredBin>& bins = *found.bins;
  const ScoredBin& bin = bins[static_cast<std::size_t>(found.pose.bin)];
  const SearchProblem problem{bins, tables, *found.constraint, model.bounding_radius_m};
  const double least = found.score - kNearlyAsGood * (bin.offset - bin.zero);
  std::vector<PoseEstimate> out;
  for (const ScoredPose& other :
       other_turns(problem, found.pose, model.symmetry_deg, least, kMostOtherTurns)) {
    PoseEstimate turned = answer;
    turned.camera_from_object =
        transform_from_pose(found.constraint->camera(), pose_of(other.pose)) * model.object_from_mesh;
    turned.log_score = other.score;
    turned.evidence_share = evidence_share(bins[static_cast<std::size_t>(other.pose.bin)], other.score);
    turned.upper_bound = std::max(answer.upper_bound, answer.log_score);
    turned.gap = std::max(0.0, turned.upper_bound - other.score);
    turned.status = turned.gap == 0 ? answer.status : SearchStatus::kBounded;
    turned.runner_up_margin = 0;
    turned.runner_up_exact = false;
    out.push_back(std::move(turned));
  }
  return out;
}

void AnswerRefiner::choose_turn(const RefineFrame& seen, std::size_t slot, PoseEstimate& turned,
                                PoseEstimate& answer) {
  const RigidTransform mesh_from_object = models_[answer.model_index].object_from_mesh.inverse();
  turned.refinement.other_turn = true;
  const double better = refiner(answer.model_index, slot)
                            .compare(seen, answer.camera_from_object * mesh_from_object,
                                     turned.camera_from_object * mesh_from_object);
  // Where the shape is the same either way, the print and the outline tell.
  if (better > kClearlyBetter || (better == 0 && turned.score > answer.score)) answer = turned;
}

}  // namespace sextant
