// SPDX-License-Identifier: Apache-2.0
// One sensor_msgs/Image topic as a stream of images: any ROS 2 camera driver feeds us.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "hal/dds/image_message.h"
#include "hal/dds/subscription.h"

namespace sextant {

struct DdsImageOptions {
  std::string topic;  ///< as ROS 2 names it, e.g. "camera/color/image_raw"
  ImageKind kind = ImageKind::kColour;
  /// Images are taken to be captured when they arrive. For drivers whose stamps are of another clock.
  bool stamp_on_arrival = false;
  /// A stamp farther than this from our clock is not believed (the image counts as kBadTime); ages would be
  /// nonsense.
  std::chrono::seconds believable{30};
  std::chrono::milliseconds starved_after{2000};
};

/// The newest image that arrived; ones before it count as superseded, messages that break their promises as
/// damaged. state(): kWaiting while no image has come for a second; condition() says why. Throws UsageError /
/// DeviceError.
std::unique_ptr<ImageSource> open_dds_images(std::shared_ptr<const DdsParticipant> participant,
                                             const DdsImageOptions& options);

}  // namespace sextant
