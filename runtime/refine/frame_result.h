// SPDX-License-Identifier: Apache-2.0
// The answer for one frame: poses, best first, each with its certificate; and per object what was proven.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/geometry/table_geometry.h"
#include "runtime/refine/refinement.h"

namespace sextant {

/// What the search proved.
enum class SearchStatus : std::uint8_t {
  kOptimal = 0,  ///< the reported poses are the best ones, gap 0
  kBounded = 1,  ///< stopped at the deadline: best so far, and how much better any other could be
  kAbsent = 2,   ///< proven: no pose reaches the threshold
};

inline const char* to_string(SearchStatus status) {
  switch (status) {
    case SearchStatus::kOptimal:
      return "optimal";
    case SearchStatus::kBounded:
      return "bounded";
    case SearchStatus::kAbsent:
      return "absent";
  }
  return "?";
}

/// One pose of one object.
struct PoseEstimate {
  std::size_t model_index = 0;  ///< of the detector's models
  int object_id = 0;
  std::string object_name;
  RigidTransform camera_from_object = RigidTransform::Identity();  ///< of the mesh's own frame, metres
  Eigen::Matrix<double, 6, 6> covariance =
      Eigen::Matrix<double, 6, 6>::Zero();  ///< x y z rx ry rz; 0: unknown
  Refinement refinement;                    ///< how the pose was refined, and how well it explains the frame
  double score = 0;           ///< in [0, 1]: the probability that the pose is right within 1 cm and 15 deg
  double evidence_share = 0;  ///< of the best possible log score, in [0, 1]
  double log_score = 0;       ///< the score that the search maximises
  double upper_bound = 0;     ///< no pose that is neither reported nor suppressed scores higher
  double gap = 0;             ///< max(0, upper_bound - log_score)
  /// Proven: outside of the balls around the reported poses no pose that no better one suppresses has a score
  /// that is less than this below log_score. 0: nothing is proven (not asked for, out of time, or a tie).
  double runner_up_margin = 0;
  bool runner_up_exact = false;  ///< such a pose exists exactly that far below; false: it may be farther
  SearchStatus status = SearchStatus::kOptimal;
  std::array<double, 4> bbox{};  ///< x, y, width, height, pixels of the source image
};

/// What is known of one object in this frame, also where there is no detection.
struct ObjectOutcome {
  std::size_t model_index = 0;  ///< of the detector's models
  int object_id = 0;
  std::string object_name;
  SearchStatus status = SearchStatus::kAbsent;  ///< of the search; a reported pose has its own
  double upper_bound = 0;       ///< of every pose that is neither reported nor suppressed by a reported one
  double threshold = 0;         ///< log score that a pose had to reach
  double coverage = 1;          ///< share of the feasible poses that the model's bins cover
  int doubtful = 0;             ///< detections left out because their confidence is below `least_confidence`
  double least_confidence = 0;  ///< that follows from the wanted false-positive rate
};

/// Who said where the table is.
enum class TableProvenance : std::uint8_t {
  kFrame = 0,     ///< the source of the frames
  kEstimate = 1,  ///< fitted to this frame's depth
  kFixed = 2,     ///< the configuration
};

/// Seconds of each stage.
struct StageSeconds {
  double features = 0, tables = 0, search = 0, refine = 0, total = 0;
};

/// All of it.
struct FrameResult {
  CaptureTime captured_at{};
  std::string frame_id;
  std::int64_t sequence = 0;
  std::int64_t scene_id = 0;
  std::int64_t image_id = 0;
  std::vector<ObjectOutcome> objects;   ///< one per model
  std::vector<PoseEstimate> estimates;  ///< by object, best first
  std::uint64_t nodes = 0;              ///< boxes that the search bounded
  StageSeconds seconds;
  std::optional<TableGeometry> table;  ///< that the poses stand on; empty: no constraint
  TableProvenance table_origin = TableProvenance::kFrame;
};

}  // namespace sextant
