// SPDX-License-Identifier: Apache-2.0
// sensor_msgs/Image and CameraInfo from the wire, hostile until checked, as the images and calibrations of
// the hardware layer.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/image_source.h"
#include "idl/dds/sensor_msgs.h"
#include "runtime/geometry/camera_model.h"

namespace sextant {

using ImageMessage = sensor_msgs_msg_dds__Image_;
using CameraInfoMessage = sensor_msgs_msg_dds__CameraInfo_;

/// What a topic should carry.
enum class ImageKind : std::uint8_t { kColour, kDepth };

/// The encodings that are read: colour rgb8, bgr8, rgba8, bgra8, mono8, yuv422 (also uyvy), yuv422_yuy2 (also
/// yuyv), 8UC1, 8UC3; depth 16UC1 (also mono16), 32FC1.
std::vector<std::string> known_encodings(ImageKind kind);

/// An Image message that keeps its promises, copied out of the message: encoding of the kind, 16..16384
/// pixels a side, step and data of the size that follows. Big-endian values are swapped, alpha is dropped.
/// captured is the header's stamp; its monotonic time by `clocks`. sequence stays 0. Throws
/// InputError(topic).
RawImage raw_image_of(const ImageMessage& message, ImageKind kind, const CaptureStamp& clocks,
                      const std::string& topic);

/// A calibrated camera without binning or region of interest, distortion model "", plumb_bob or
/// rational_polynomial. Throws InputError(topic).
CameraModel camera_of(const CameraInfoMessage& message, const std::string& topic);

/// frame_id as text of at most 200 characters; throws InputError(topic) for anything longer.
std::string frame_of(const char* frame_id, const std::string& topic);

/// Throws InputError(topic) for a stamp that is no time.
CaptureTime time_of(std::int32_t sec, std::uint32_t nanosec, const std::string& topic);

}  // namespace sextant
