// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/result_json.h"

#include <nlohmann/json.hpp>

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json refinement_json(const Refinement& r) {
  return {{"refined", r.refined},
          {"left_neighbourhood", r.left_neighbourhood},
          {"other_turn", r.other_turn},
          {"shift_m", r.shift_m},
          {"turn_rad", r.turn_rad},
          {"depth_inlier_share", r.depth_inlier_share},
          {"off_surface_share", r.off_surface_share},
          {"occluded_share", r.occluded_share},
          {"missing_share", r.missing_share},
          {"depth_rms_m", r.depth_rms_m},
          {"edge_inlier_share", r.edge_inlier_share},
          {"outline_inlier_share", r.outline_inlier_share},
          {"mark_inlier_share", r.mark_inlier_share},
          {"edge_rms_px", r.edge_rms_px}};
}

}  // namespace

std::string format_result_json(const FrameResult& result) {
  Json objects = Json::array();
  for (const ObjectOutcome& object : result.objects) {
    objects.push_back({{"obj_id", object.object_id},
                       {"name", object.object_name},
                       {"status", to_string(object.status)},
                       {"upper_bound", object.upper_bound},
                       {"coverage", object.coverage},
                       {"doubtful", object.doubtful},
                       {"least_confidence", object.least_confidence}});
  }
  Json detections = Json::array();
  for (const PoseEstimate& estimate : result.estimates) {
    Json pose = Json::array();
    for (int row = 0; row < 4; ++row) {
      const auto m = estimate.camera_from_object.matrix().row(row);
      pose.push_back({m(0), m(1), m(2), m(3)});
    }
    Json covariance = Json::array();
    for (int row = 0; row < 6; ++row) {
      const auto c = estimate.covariance.row(row);
      covariance.push_back({c(0), c(1), c(2), c(3), c(4), c(5)});
    }
    detections.push_back({{"obj_id", estimate.object_id},
                          {"name", estimate.object_name},
                          {"score", estimate.score},
                          {"evidence_share", estimate.evidence_share},
                          {"log_score", estimate.log_score},
                          {"upper_bound", estimate.upper_bound},
                          {"gap", estimate.gap},
                          {"runner_up_margin", estimate.runner_up_margin},
                          {"runner_up_exact", estimate.runner_up_exact},
                          {"status", to_string(estimate.status)},
                          {"camera_from_object", pose},
                          {"covariance", covariance},
                          {"refinement", refinement_json(estimate.refinement)},
                          {"bbox", estimate.bbox}});
  }
  const StageSeconds& s = result.seconds;
  const Json json = {{"scene_id", result.scene_id},
                     {"im_id", result.image_id},
                     {"seconds",
                      {{"features", s.features},
                       {"tables", s.tables},
                       {"search", s.search},
                       {"refine", s.refine},
                       {"total", s.total}}},
                     {"nodes", result.nodes},
                     {"objects", objects},
                     {"detections", detections}};
  return json.dump();
}

}  // namespace sextant
