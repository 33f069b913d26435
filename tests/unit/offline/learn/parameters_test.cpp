// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/parameters.h"

#include <gtest/gtest.h>

#include <fstream>

#include "runtime/base/error.h"

namespace sextant {
namespace {

std::filesystem::path file_with(const std::string& text) {
  const auto file = std::filesystem::path(testing::TempDir()) / "parameters.yaml";
  std::ofstream(file) << text;
  return file;
}

TEST(LearnParameters, ReadsWhatItWrites) {
  LearnParameters p;
  p.images_per_bin = 33;
  p.visual_radius_px = 4.5;
  p.camera.focal = 600;
  p.seed = 77;
  const LearnParameters back = read_learn_parameters(file_with(p.to_yaml()));
  EXPECT_EQ(back.to_yaml(), p.to_yaml());
  EXPECT_EQ(back.images_per_bin, 33);
  EXPECT_EQ(back.seed, 77U);
}

TEST(LearnParameters, RefusesWhatMakesNoSense) {
  EXPECT_THROW(read_learn_parameters(file_with("gird: 96\n")), InputError);
  EXPECT_THROW(read_learn_parameters(file_with("grid: many\n")), InputError);
  EXPECT_THROW(read_learn_parameters(file_with("grid: 1\n")), InputError);
  EXPECT_THROW(read_learn_parameters(file_with("grid: 96.5\n")), InputError);
  EXPECT_THROW(read_learn_parameters(file_with("- 1\n- 2\n")), InputError);
  EXPECT_THROW(read_learn_parameters(file_with("{{{")), InputError);
  EXPECT_THROW(read_learn_parameters("/nonexistent/file.yaml"), InputError);
  EXPECT_THROW(read_learn_parameters(file_with("min_pitch_deg: 60\nmax_pitch_deg: 40\n")), UsageError);
}

}  // namespace
}  // namespace sextant
