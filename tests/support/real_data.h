// SPDX-License-Identifier: Apache-2.0
// Where the real RGB-D data sets are on this machine: the environment variable SEXTANT_RGBD, else what CMake
// was told in SEXTANT_RGBD_DIR. Tests that need them skip, with the reason, where there are none.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace sextant {

inline std::optional<std::filesystem::path> real_data_folder(const char* data_set) {
  const char* from_environment = std::getenv("SEXTANT_RGBD");
  const std::filesystem::path root = from_environment ? from_environment : SEXTANT_RGBD_DIR;
  if (root.empty() || !std::filesystem::exists(root / data_set)) return std::nullopt;
  return root / data_set;
}

}  // namespace sextant

/// First line of a test that needs a real data set: `const std::filesystem::path NAME = ...`, or skip.
#define SEXTANT_NEEDS_REAL_DATA(name, data_set)                                                \
  const auto name##_found = sextant::real_data_folder(data_set);                               \
  if (!name##_found) GTEST_SKIP() << "set SEXTANT_RGBD to the folder that holds " << data_set; \
  const std::filesystem::path name = *name##_found
