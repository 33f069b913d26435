// SPDX-License-Identifier: Apache-2.0
// Two DDS domains that are one on the wire: what is written in `writing` travels over loopback UDP to
// `reading`, in one process. (Within one domain Cyclone hands samples over in memory.) Random, so that tests
// can run side by side. The settings are those that ship in config/.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <random>
#include <string>

namespace sextant {

struct DdsTestDomain {
  unsigned writing = 0;
  unsigned reading = 0;
  std::string name_space;  ///< another belt: no other test's topics

  /// `more`: settings on top, as CYCLONEDDS_URI takes them.
  explicit DdsTestDomain(const std::string& config = "cyclonedds.xml", const std::string& more = "") {
    std::random_device random;
    writing = 1 + random() % 200;
    reading = writing + 1;
    name_space = "test_" + std::to_string(getpid());
    const std::string uri = "file://" SEXTANT_SOURCE_DIR "/config/" + config +
                            (more.empty() ? "" : "," + more) + ",<CycloneDDS><Domain Id=\"" +
                            std::to_string(reading) + "\"><Discovery><ExternalDomainId>" +
                            std::to_string(writing) + "</ExternalDomainId></Discovery></Domain></CycloneDDS>";
    if (setenv("CYCLONEDDS_URI", uri.c_str(), 1) != 0) ADD_FAILURE() << "setenv";
  }
};

}  // namespace sextant
