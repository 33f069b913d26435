// SPDX-License-Identifier: Apache-2.0
// Where single images come from: one colour or one depth stream (a V4L2 node, a libcamera camera, a DDS
// topic). A pair of them becomes a FrameSource by synchronisation and registration.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "hal/pixel_format.h"
#include "hal/source_status.h"
#include "runtime/frame/capture_time.h"

namespace sextant {

/// An image as the device wrote it. The bytes may lie in the device's own buffer, which returns to the device
/// when the last copy of `buffer` goes: decode soon (hal/pixels), keep the decoded image, not this.
struct RawImage {
  PixelFormat format = PixelFormat::kYuyv;
  int width = 0;           ///< pixels
  int height = 0;          ///< pixels
  std::size_t stride = 0;  ///< bytes from line to line; 0 for compressed formats
  /// At least image_bytes(format, width, height, stride); for compressed formats what came.
  std::span<const std::byte> bytes;
  CaptureStamp captured;               ///< start of exposure or of arrival, as the device says
  std::int64_t sequence = 0;           ///< of the device, wraps removed; rises, gaps are lost images
  std::shared_ptr<const void> buffer;  ///< keeps the bytes and dma_buf_fd alive
  int dma_buf_fd = -1;                 ///< the same bytes as a DMA-BUF, where the driver exports them
};

/// One stream. Threads, errors, next(), state(), condition(), statistics() and close() as of FrameSource.
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  virtual std::optional<RawImage> next(std::chrono::milliseconds timeout) = 0;
  virtual SourceState state() const = 0;
  virtual std::string condition() const { return {}; }
  virtual SourceStatistics statistics() const = 0;
  virtual void close() = 0;
  /// What it is, for messages: "v4l2 usb-0000:00:14.0-1 (HD Webcam)".
  virtual std::string name() const = 0;
};

}  // namespace sextant
