// SPDX-License-Identifier: Apache-2.0
// A ROS 2 RGB-D camera as a source of frames: colour and depth images with their CameraInfo, paired and
// registered. RealSense, Orbbec and Azure drivers publish exactly these topics.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "hal/frame_source.h"
#include "hal/pairing/paired_source.h"

namespace sextant {

struct DdsRgbdOptions {
  unsigned domain = 0;       ///< 0..230
  std::string colour_topic;  ///< e.g. "camera/color/image_raw"
  std::string depth_topic;   ///< e.g. "camera/aligned_depth_to_color/image_raw"
  /// Empty: "camera_info" beside the image topic, as ROS 2 drivers do.
  std::string colour_info_topic, depth_info_topic;
  /// Instead of CameraInfo and tf.
  std::optional<RgbdCalibration> calibration;
  /// Instead of tf, where depth is not registered.
  std::optional<RigidTransform> colour_from_depth;
  bool stamp_on_arrival = false;
  PairedSourceOptions pairing;  ///< its calibration is ignored; frame_id empty: that of the colour images
};

/// Waits for both CameraInfos (kWaiting, condition() says which is missing). Depth counts as registered when
/// its CameraInfo has the frame_id, size and K of the colour camera; else the transform between the two frame
/// ids comes from the options or from tf. When a CameraInfo changes, pairing begins again with it. Throws
/// UsageError / DeviceError.
std::unique_ptr<FrameSource> open_dds_rgbd(const DdsRgbdOptions& options);

}  // namespace sextant
