// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/temperatures.h"

#include <fmt/format.h>

#include <fstream>

namespace sextant {

namespace {

constexpr int kMostZones = 64;
/// Zones that are off report values such as -274 or 0.
constexpr double kColdest = -60, kWarmest = 200;

}  // namespace

std::vector<std::pair<std::string, double>> read_temperatures(const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, double>> zones;
  for (int i = 0; i < kMostZones; ++i) {
    const std::filesystem::path zone = folder / fmt::format("thermal_zone{}", i);
    std::string type;
    double thousandths = 0;
    if (!(std::ifstream(zone / "temp") >> thousandths)) continue;
    std::getline(std::ifstream(zone / "type"), type);
    const double celsius = thousandths / 1000;
    if (celsius <= kColdest || celsius >= kWarmest) continue;
    zones.emplace_back(fmt::format("{} ({})", type.empty() ? "zone" : type, i), celsius);
  }
  return zones;
}

}  // namespace sextant
