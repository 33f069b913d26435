// SPDX-License-Identifier: Apache-2.0
#include "offline/tune/tune_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hal/image/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

using testing::HasSubstr;

TuneRun some_run() {
  TuneRun run;
  run.sweeps = {{"depth_parts", {"50", "150"}}};
  return run;
}

TuneResult some_result() {
  TuneResult result;
  result.points = {{}, {{"depth_parts", "50"}}, {{"depth_parts", "150"}}};
  result.training = {
      {10, 8, 0.7, 0.6, 0.3, 0.02}, {10, 8, 0.9, 0.8, 0.4, 0.01}, {10, 8, 0.65, 0.5, 0.3, 0.03}};
  result.best = 1;
  result.held_out_defaults = {9, 7, 0.6, 0.5, 0.2, 0.02};
  result.held_out_best = {9, 7, 0.8, 0.75, 0.35, 0.01};
  return result;
}

TEST(TuneReport, TextAndJsonSayTheSame) {
  const std::string text = format_tune_text(some_run(), some_result());
  EXPECT_THAT(text, HasSubstr("depth_parts=50"));
  EXPECT_THAT(text, HasSubstr("<- best"));
  EXPECT_THAT(text, HasSubstr("held-out half (9 images, 7 instances"));
  const nlohmann::json json = nlohmann::json::parse(format_tune_json(some_run(), some_result()));
  EXPECT_EQ(1, json["best"]);
  EXPECT_EQ("50", json["parameters"]["depth_parts"]);
  EXPECT_EQ(0.8, json["held_out"]["best"]["average_precision"]);
  EXPECT_EQ(3U, json["points"].size());
}

TEST(TuneReport, PageHasAPlotPerParameter) {
  const std::string html = format_tune_html(some_run(), some_result(), "T");
  EXPECT_NE(std::string::npos, html.find("<canvas data-chart=\"depth_parts\">"));
  EXPECT_NE(std::string::npos, html.find("[0.7,0.9,0.65]"));
}

TEST(TuneReport, TunedParametersAreReadByCompile) {
  const TemporaryFolder folder;
  TuneParameters base;
  base.learn.visual_parts = 77;
  const std::string yaml = format_tuned_yaml(some_result(), base);
  write_file_bytes(folder / "tuned.yaml", std::as_bytes(std::span(yaml)));
  const LearnParameters read = read_learn_parameters(folder / "tuned.yaml");
  EXPECT_EQ(50, read.depth_parts);
  EXPECT_EQ(77, read.visual_parts);
  EXPECT_EQ(base.learn.seed, read.seed);
}

}  // namespace
}  // namespace sextant
