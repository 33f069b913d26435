// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/dds_settings.h"

#include <cstdlib>
#include <stdexcept>

namespace sextant {

std::string dds_defaults() {
  return "<CycloneDDS><Domain Id=\"any\"><Internal><Watermarks><WhcHigh>8MB</WhcHigh>"
         "<WhcHighInit>8MB</WhcHighInit><WhcAdaptive>false</WhcAdaptive></Watermarks></Internal>"
         "</Domain></CycloneDDS>";
}

void use_dds_defaults() {
  const char* own = std::getenv("CYCLONEDDS_URI");
  std::string all = dds_defaults();
  if (own != nullptr && *own != '\0') {
    all += ',';
    all += own;
  }
  if (setenv("CYCLONEDDS_URI", all.c_str(), 1) != 0) throw std::runtime_error("setenv");
}

}  // namespace sextant
