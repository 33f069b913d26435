// SPDX-License-Identifier: Apache-2.0
// From what the search found to what is reported: the continuous pose with its covariance and confidence.
// Where the score hardly tells which way an object is turned, the rigid model may: it sees every pixel.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "runtime/base/worker_pool.h"
#include "runtime/geometry/camera_model.h"
#include "runtime/refine/frame_result.h"
#include "runtime/refine/refiner.h"
#include "runtime/search/constraint.h"
#include "runtime/search/lattice.h"
#include "runtime/search/scored_bin.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

/// The lattice pose behind an estimate, and where it was found.
struct FoundPose {
  LatticePose pose;
  double score = 0;
  const std::vector<ScoredBin>* bins = nullptr;
  const Constraint* constraint = nullptr;
};

/// Holds a refiner of every model for every thread of the pool. One frame at a time.
class AnswerRefiner {
 public:
  /// Keeps references to the models and the pool.
  AnswerRefiner(const std::vector<ObjectModel>& models, WorkerPool& pool);

  /// Replaces the lattice poses of the answers by continuous ones, or by other turns that fit the picture
  /// better; such a turn is no longer the optimum of the score, and its certificate says by how much. camera:
  /// of the source image; found: one for each answer, from `tables`. The same for any number of threads.
  void refine(const RefineFrame& seen, const CameraModel& camera, const FrameTables& tables,
              std::span<const FoundPose> found, std::span<PoseEstimate> answers);

 private:
  Refiner& refiner(std::size_t model, std::size_t slot);
  void for_each_with_slot(std::size_t items, const std::function<void(std::size_t, std::size_t)>& work);
  void refine_one(const RefineFrame& seen, const CameraModel& camera, std::size_t slot, PoseEstimate& answer);
  std::vector<PoseEstimate> turned_otherwise(const FrameTables& tables, const PoseEstimate& answer,
                                             const FoundPose& found) const;
  void choose_turn(const RefineFrame& seen, std::size_t slot, PoseEstimate& turned, PoseEstimate& answer);

  const std::vector<ObjectModel>& models_;
  WorkerPool& pool_;
  std::vector<std::vector<std::unique_ptr<Refiner>>> refiners_;  ///< per model and thread, made when needed
};

}  // namespace sextant
