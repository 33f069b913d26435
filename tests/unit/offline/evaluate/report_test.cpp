// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "offline/evaluate/report_text.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::Not;

EvaluationReport small_report() {
  EvaluationReport report;
  report.images = 3;
  report.mean_seconds = 0.5;
  ObjectReport object;
  object.name = "object 7";
  object.instances = 4;
  object.found = 3;
  object.right = 1;
  object.detections = 5;
  object.median_rotation_deg = 12.5;
  object.average_precision = 0.625;
  report.objects[7] = object;
  report.total = object;
  InstanceResult missed;
  missed.scene_id = 1;
  missed.image_id = 2;
  missed.object_id = 7;
  InstanceResult off = missed;
  off.found = true;
  off.translation_cm = 3.25;
  off.add_mm = 31;
  report.instances = {missed, off};
  return report;
}

TEST(Report, TextHasOneLinePerObject) {
  const std::string text = format_report_text(small_report());
  EXPECT_THAT(text, HasSubstr("object 7"));
  EXPECT_THAT(text, HasSubstr("25.0 %"));
  EXPECT_THAT(text, HasSubstr("12.5"));
  EXPECT_THAT(text, HasSubstr("0.625"));
  EXPECT_THAT(text, HasSubstr("3 images, 0.500 s each"));
}

TEST(Report, JsonIsOneLineOfTheSameNumbers) {
  const std::string line = format_report_json(small_report());
  EXPECT_THAT(line, Not(HasSubstr("\n")));
  const nlohmann::json json = nlohmann::json::parse(line);
  EXPECT_EQ(0.25, json["total"]["share_right"]);
  EXPECT_EQ(0.2, json["objects"]["7"]["precision"]);
  EXPECT_TRUE(json["total"]["add_recall"].is_null());
  EXPECT_TRUE(json["instances"][0]["translation_cm"].is_null());
  EXPECT_EQ(3.25, json["instances"][1]["translation_cm"]);
}

}  // namespace
}  // namespace sextant
