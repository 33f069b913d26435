// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/result_json.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace sextant {
namespace {

TEST(ResultJson, HasExactlyTheDocumentedKeys) {
  FrameResult result;
  result.scene_id = 1;
  result.image_id = 2;
  result.nodes = 345;
  result.seconds = {0.1, 0.2, 0.3, 0.4, 1.0};
  ObjectOutcome outcome;
  outcome.object_id = 7;
  outcome.status = SearchStatus::kAbsent;
  outcome.upper_bound = -std::numeric_limits<double>::infinity();
  outcome.coverage = 0.5;
  outcome.doubtful = 2;
  outcome.least_confidence = 0.25;
  result.objects = {outcome};
  PoseEstimate estimate;
  estimate.object_name = "mug";
  estimate.object_id = 8;
  estimate.score = 0.75;
  estimate.evidence_share = 0.5;
  estimate.covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  estimate.refinement.refined = true;
  estimate.refinement.other_turn = true;
  estimate.refinement.shift_m = 0.004;
  estimate.refinement.turn_rad = 0.02;
  estimate.refinement.depth_inlier_share = 0.5;
  estimate.refinement.off_surface_share = 0.25;
  estimate.refinement.occluded_share = 0.125;
  estimate.refinement.missing_share = 0.125;
  estimate.refinement.depth_rms_m = 0.002;
  estimate.refinement.edge_inlier_share = 0.75;
  estimate.refinement.outline_inlier_share = 0.875;
  estimate.refinement.mark_inlier_share = 0.625;
  estimate.refinement.edge_rms_px = 0.5;
  estimate.log_score = -3;
  estimate.upper_bound = -2;
  estimate.gap = 1;
  estimate.runner_up_margin = 12.5;
  estimate.runner_up_exact = true;
  estimate.status = SearchStatus::kBounded;
  estimate.camera_from_object.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  estimate.camera_from_object.translation() = Eigen::Vector3d(5, 6, 7);
  estimate.bbox = {1, 2, 3, 4};
  result.estimates = {estimate};
  const std::string line = format_result_json(result);
  EXPECT_EQ(std::string::npos, line.find('\n'));
  const nlohmann::json expected = nlohmann::json::parse(R"({
    "scene_id": 1, "im_id": 2,
    "seconds": {"features": 0.1, "tables": 0.2, "search": 0.3, "refine": 0.4, "total": 1.0}, "nodes": 345,
    "objects": [{"obj_id": 7, "name": "", "status": "absent", "upper_bound": null, "coverage": 0.5, "doubtful": 2,
      "least_confidence": 0.25}],
    "detections": [{"obj_id": 8, "name": "mug", "score": 0.75, "evidence_share": 0.5, "log_score": -3.0, "upper_bound": -2.0, "gap": 1.0,
      "runner_up_margin": 12.5, "runner_up_exact": true,
      "status": "bounded", "camera_from_object": [[0,-1,0,5],[1,0,0,6],[0,0,1,7],[0,0,0,1]],
      "covariance": [[1,0,0,0,0,0],[0,2,0,0,0,0],[0,0,3,0,0,0],[0,0,0,4,0,0],[0,0,0,0,5,0],[0,0,0,0,0,6]],
      "refinement": {"refined": true, "left_neighbourhood": false, "other_turn": true, "shift_m": 0.004, "turn_rad": 0.02,
        "depth_inlier_share": 0.5, "off_surface_share": 0.25, "occluded_share": 0.125, "missing_share": 0.125,
        "depth_rms_m": 0.002, "edge_inlier_share": 0.75, "outline_inlier_share": 0.875, "mark_inlier_share": 0.625, "edge_rms_px": 0.5},
      "bbox": [1,2,3,4]}]})");
  EXPECT_EQ(expected, nlohmann::json::parse(line));
}

}  // namespace
}  // namespace sextant
