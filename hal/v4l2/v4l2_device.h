// SPDX-License-Identifier: Apache-2.0
// An open V4L2 node: the one place where its ioctls are called.
#pragma once

#include <linux/videodev2.h>

#include <cstdint>
#include <string>

namespace sextant {

class V4l2Device {
 public:
  /// Opens without blocking. Throws DeviceUnready where there is no such node, DeviceError without
  /// permission.
  explicit V4l2Device(const std::string& node);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  /// 0 or the errno; interrupted calls are made again.
  int call(unsigned long request, void* argument) const;
  int fd() const { return fd_; }
  const std::string& node() const { return node_; }

  /// What the node itself can do (not its siblings); 0 where it is no V4L2 node.
  std::uint32_t capabilities() const;
  const v4l2_capability& description() const { return description_; }
  /// V4L2_BUF_TYPE_VIDEO_CAPTURE or ..._MPLANE; 0 where it captures no video by streaming.
  std::uint32_t capture_type() const;

 private:
  std::string node_;
  int fd_ = -1;
  v4l2_capability description_{};
};

/// "errno text (NAME)" for messages.
std::string error_text(int error);

}  // namespace sextant
