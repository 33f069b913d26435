// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/result_json.h"

#include <nlohmann/json.hpp>

namespace sextant {

std::string format_result_json(const FrameResult& result) {
  using Json = nlohmann::ordered_json;
  Json objects = Json::array();
  for (const ObjectOutcome& object : result.objects) {
    objects.push_back({{"obj_id", object.object_id},
                       {"status", to_string(object.status)},
                       {"upper_bound", object.upper_bound},
                       {"coverage", object.coverage}});
  }
  Json detections = Json::array();
  for (const PoseEstimate& estimate : result.estimates) {
    Json pose = Json::array();
    for (int row = 0; row < 4; ++row) {
      const auto m = estimate.camera_from_object.matrix().row(row);
      pose.push_back({m(0), m(1), m(2), m(3)});
    }
    detections.push_back({{"obj_id", estimate.object_id},
                          {"score", estimate.score},
                          {"log_score", estimate.log_score},
                          {"upper_bound", estimate.upper_bound},
                          {"gap", estimate.gap},
                          {"status", to_string(estimate.status)},
                          {"camera_from_object", pose},
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
