// SPDX-License-Identifier: Apache-2.0
// The options of detection, shared by sextant detect and sextant-mpi detect.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/detect/detector.h"

namespace sextant {

struct DetectArguments {
  std::vector<std::filesystem::path> models;
  std::filesystem::path dataset;
  std::string split = "test";
  int scene = -1;
  int image = -1;
  std::filesystem::path colour, depth, camera;
  std::filesystem::path csv;
  std::filesystem::path overlay;
  std::filesystem::path proof;
  std::string table = "file";
  std::string region, workspace, camera_pose;
  DetectOptions detect;
  double angle_tolerance_deg = 12;
  double runner_up_angle_deg = 30;
  std::optional<double> threshold;
  bool json = false;
  bool require = false;

  void add_to(CLI::App& command);
  /// DetectOptions with --table and the tolerances applied. Throws UsageError.
  DetectOptions options() const;
};

}  // namespace sextant
