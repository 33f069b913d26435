// SPDX-License-Identifier: Apache-2.0
// How warm the machine is, where the kernel tells: /sys/class/thermal.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace sextant {

/// Name and degrees Celsius of each thermal zone, by number; empty where there is none or it cannot be read.
std::vector<std::pair<std::string, double>> read_temperatures(
    const std::filesystem::path& folder = "/sys/class/thermal");

}  // namespace sextant
