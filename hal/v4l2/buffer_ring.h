// SPDX-License-Identifier: Apache-2.0
// The memory-mapped buffers of a streaming V4L2 node. A full buffer is lent to the consumer without a copy
// and goes back to the driver when the last holder lets go, from whatever thread.
#pragma once

#include <linux/videodev2.h>

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "hal/v4l2/v4l2_device.h"

namespace sextant {

class BufferRing : public std::enable_shared_from_this<BufferRing> {
 public:
  /// A buffer that the driver filled, or why there is none.
  struct Filled {
    int error = 0;                      ///< errno: EAGAIN for none yet
    v4l2_buffer info{};                 ///< flags, sequence, timestamp
    std::span<const std::byte> bytes;   ///< those used
    std::shared_ptr<const void> lease;  ///< gives it back
    int dma_buf_fd = -1;
  };

  /// Asks for buffers, maps and queues them, and starts streaming. Throws DeviceUnready(where).
  static std::shared_ptr<BufferRing> start(std::shared_ptr<const V4l2Device> device, int count,
                                           bool export_dma_buf, const std::string& where);
  ~BufferRing();
  BufferRing(const BufferRing&) = delete;
  BufferRing& operator=(const BufferRing&) = delete;

  Filled take();
  /// Ends streaming. Lent buffers stay readable until they are let go.
  void stop();
  int size() const { return static_cast<int>(buffers_.size()); }
  /// Buffers that the driver has.
  int queued() const;

 private:
  struct Mapped {
    std::byte* data = nullptr;
    std::size_t size = 0;
    int dma_buf_fd = -1;
  };

  explicit BufferRing(std::shared_ptr<const V4l2Device> device) : device_(std::move(device)) {}
  void map_all(int count, bool export_dma_buf, const std::string& where);
  /// The errno of VIDIOC_QBUF.
  int queue(std::uint32_t index);
  void give_back(std::uint32_t index);

  const std::shared_ptr<const V4l2Device> device_;
  std::vector<Mapped> buffers_;
  mutable std::mutex mutex_;
  bool streaming_ = false;
  int queued_ = 0;
};

}  // namespace sextant
