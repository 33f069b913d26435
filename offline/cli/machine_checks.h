// SPDX-License-Identifier: Apache-2.0
// What `sextant doctor` looks at, one function a check. Where the kernel shows things comes in as a folder,
// so that tests can show another machine.
#pragma once

#include <filesystem>
#include <vector>

#include "offline/cli/finding.h"

namespace sextant {

/// Roots of /proc, /sys, /dev and /etc.
struct MachinePlaces {
  std::filesystem::path root = "/";
};

/// SIMD and number of cores; the frequency governor.
std::vector<Finding> check_processor(const MachinePlaces& places);
/// MemAvailable.
std::vector<Finding> check_memory(const MachinePlaces& places);
/// net.core.rmem_max and rmem_default against what images over DDS need.
std::vector<Finding> check_socket_buffers(const MachinePlaces& places);
/// Camera nodes and whether this user may open them.
std::vector<Finding> check_camera_permissions(const MachinePlaces& places);
/// Is the wall clock disciplined? Stamps of cameras on other machines need it.
std::vector<Finding> check_clock();
/// Images over DDS to ourselves.
std::vector<Finding> check_dds(unsigned domain);
/// An OpenGL context without a display, for compile and render.
std::vector<Finding> check_rendering();
/// Each model opens and passes its checksum.
std::vector<Finding> check_models(const std::vector<std::filesystem::path>& models);
/// Space for recordings where we are.
std::vector<Finding> check_disk(const std::filesystem::path& folder);

}  // namespace sextant
