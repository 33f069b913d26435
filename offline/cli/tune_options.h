// SPDX-License-Identifier: Apache-2.0
// The options of `tune`, shared by sextant and sextant-mpi, and the run that they describe.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "offline/cli/mesh_options.h"
#include "offline/tune/detector_trial.h"

namespace sextant {

struct TuneArguments {
  std::filesystem::path mesh, dataset, held_out, parameter_file, folder, report;
  std::string split = "test", metric = "ap", scoring = "likelihood";
  std::vector<std::string> sweeps;
  MeshArguments mesh_arguments;
  std::optional<int> id;
  double height_tolerance_m = DetectOptions{}.tolerance.height_m;
  double deadline_ms = 0;
  int threads = 0;
  bool grid = false;
  bool json = false;

  void add_to(CLI::App& command);
};

/// A run that is ready to go. Reads mesh and data set. Throws UsageError, InputError.
struct PreparedTuning {
  TuneRun run;
  Trial trial;
  TuneParameters base;
};
PreparedTuning prepare_tuning(const TuneArguments& arguments);

/// Writes tuned.yaml and report.html into the folder and prints the result.
void report_tuning(const TuneArguments& arguments, const PreparedTuning& tuning, const TuneResult& result);

}  // namespace sextant
