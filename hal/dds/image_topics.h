// SPDX-License-Identifier: Apache-2.0
// Which image topics somebody publishes, as discovery tells.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace sextant {

/// Topics of sensor_msgs/Image in a domain, as ROS 2 names them, sorted; found within the time. Throws
/// UsageError / DeviceError.
std::vector<std::string> list_image_topics(unsigned domain, std::chrono::milliseconds listen);

}  // namespace sextant
