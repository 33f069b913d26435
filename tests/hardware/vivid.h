// SPDX-License-Identifier: Apache-2.0
// The kernel's virtual cameras (vivid) as run_hardware_test.py loads them, and the faults they make on
// demand.
//   video0, video1    HDMI inputs that show what is written to video10, video11 (loop-back)
//   video2            a webcam with a test pattern
//   video3            the same by the multi-planar interface
#pragma once

#include <linux/videodev2.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/image_source.h"
#include "hal/live/stream_options.h"
#include "hal/v4l2/v4l2_device.h"

namespace sextant::vivid {

inline constexpr char kWebcam[] = "bus:platform:vivid-002";
inline constexpr char kWebcamNode[] = "/dev/video2";
inline constexpr char kPlanarWebcam[] = "bus:platform:vivid-003";

/// YUYV 640x480 of the webcam; patient, because the machine is interpreted.
StreamOptions webcam();

/// Waits (in slices, as a pipeline does) until an image comes; nothing after a generous time.
std::optional<RawImage> next_image(ImageSource& source);
/// Waits until next() gave nothing and the state is `state`; false after a generous time.
bool reaches(ImageSource& source, SourceState state);

/// Sets a control of a node through another file than the stream's, "name=value".
void control(const std::string& node, const std::string& request);

/// Takes all virtual cameras away from the system, as pulling a plug does, and gives them back.
void unplug();
void plug();

/// Shows one frame on an output node, again and again, until it goes. The loop-back input of the same number
/// then shows it. (By streaming: the driver refuses write(2).)
class Producer {
 public:
  Producer(const std::string& node, std::uint32_t fourcc, int width, int height,
           std::vector<std::byte> frame);

 private:
  v4l2_buffer buffer_of(std::uint32_t index) const;
  void must(unsigned long request, void* argument, const char* what) const;
  void queue(std::uint32_t index) const;

  std::vector<std::byte> frame_;
  V4l2Device device_;
  std::jthread thread_;
};

/// Makes a loop-back input 640x480 and lets it show its output. False: somebody streams from it already.
bool prepare_loop(const std::string& capture, const std::string& output);

}  // namespace sextant::vivid
