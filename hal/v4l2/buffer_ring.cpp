// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/buffer_ring.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "hal/live/stream_session.h"

namespace sextant {
namespace {

/// A v4l2_buffer that describes one memory plane in either interface.
class BufferCall {
 public:
  BufferCall(const V4l2Device& device, std::uint32_t index) {
    buffer_.type = device.capture_type();
    buffer_.memory = V4L2_MEMORY_MMAP;
    buffer_.index = index;
    if (is_multi()) {
      buffer_.m.planes = &plane_;
      buffer_.length = 1;
    }
  }
  BufferCall(const BufferCall&) = delete;
  BufferCall& operator=(const BufferCall&) = delete;

  v4l2_buffer* get() { return &buffer_; }
  std::size_t length() const { return is_multi() ? plane_.length : buffer_.length; }
  off_t offset() const { return is_multi() ? plane_.m.mem_offset : buffer_.m.offset; }
  std::size_t bytes_used() const { return is_multi() ? plane_.bytesused : buffer_.bytesused; }
  std::size_t data_offset() const { return is_multi() ? plane_.data_offset : 0; }

 private:
  bool is_multi() const { return buffer_.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE; }
  v4l2_buffer buffer_{};
  v4l2_plane plane_{};
};

[[noreturn]] void fail(const std::string& where, const char* what, int error) {
  throw DeviceUnready(where, fmt::format("{}: {}", what, error_text(error)),
                      error == EBUSY ? "another program streams from it (fuser -v shows it)"
                      : error == ENOSPC
                          ? "the USB bus has no bandwidth left; use another port or a smaller mode"
                          : "unplug it and plug it in again");
}

}  // namespace

std::shared_ptr<BufferRing> BufferRing::start(std::shared_ptr<const V4l2Device> device, int count,
                                              bool export_dma_buf, const std::string& where) {
  const std::shared_ptr<BufferRing> ring(new BufferRing(std::move(device)));
  ring->map_all(count, export_dma_buf, where);
  for (std::uint32_t i = 0; i < ring->buffers_.size(); ++i) {
    if (const int error = ring->queue(i)) fail(where, "cannot queue a buffer", error);
  }
  auto type = static_cast<int>(ring->device_->capture_type());
  if (const int error = ring->device_->call(VIDIOC_STREAMON, &type))
    fail(where, "cannot start streaming", error);
  ring->streaming_ = true;
  return ring;
}

void BufferRing::map_all(int count, bool export_dma_buf, const std::string& where) {
  v4l2_requestbuffers request{};
  request.type = device_->capture_type();
  request.memory = V4L2_MEMORY_MMAP;
  request.count = static_cast<std::uint32_t>(count);
  if (const int error = device_->call(VIDIOC_REQBUFS, &request)) fail(where, "cannot get buffers", error);
  if (request.count < 2) fail(where, "the driver has memory for fewer than 2 buffers", ENOMEM);
  for (std::uint32_t i = 0; i < request.count; ++i) {
    BufferCall query(*device_, i);
    if (const int error = device_->call(VIDIOC_QUERYBUF, query.get()))
      fail(where, "cannot see a buffer", error);
    void* data = ::mmap(nullptr, query.length(), PROT_READ, MAP_SHARED, device_->fd(), query.offset());
    if (data == MAP_FAILED) fail(where, "cannot map a buffer", errno);
    buffers_.push_back({static_cast<std::byte*>(data), query.length(), -1});
    v4l2_exportbuffer exported{};
    exported.type = request.type;
    exported.index = i;
    exported.flags = O_RDONLY | O_CLOEXEC;
    if (export_dma_buf && device_->call(VIDIOC_EXPBUF, &exported) == 0)
      buffers_.back().dma_buf_fd = exported.fd;
  }
}

BufferRing::~BufferRing() {
  stop();
  for (const Mapped& buffer : buffers_) {
    ::munmap(buffer.data, buffer.size);
    if (buffer.dma_buf_fd >= 0) ::close(buffer.dma_buf_fd);
  }
}

int BufferRing::queue(std::uint32_t index) {
  BufferCall call(*device_, index);
  const int error = device_->call(VIDIOC_QBUF, call.get());
  if (error == 0) ++queued_;
  return error;
}

void BufferRing::give_back(std::uint32_t index) {
  const std::lock_guard lock(mutex_);
  // An error here is the device's end, which the next take() sees.
  if (streaming_) queue(index);
}

BufferRing::Filled BufferRing::take() {
  BufferCall call(*device_, 0);
  Filled filled;
  {
    const std::lock_guard lock(mutex_);
    filled.error = streaming_ ? device_->call(VIDIOC_DQBUF, call.get()) : ENODEV;
    if (filled.error == 0) --queued_;
  }
  if (filled.error != 0) return filled;
  filled.info = *call.get();
  filled.info.m = {};
  const std::uint32_t index = filled.info.index;
  if (index >= buffers_.size()) {
    filled.error = EIO;
    return filled;
  }
  const Mapped& buffer = buffers_[index];
  const std::size_t end = std::min(call.bytes_used(), buffer.size);
  const std::size_t begin = std::min(call.data_offset(), end);
  filled.bytes = {buffer.data + begin, end - begin};
  filled.dma_buf_fd = buffer.dma_buf_fd;
  // The ring (its mappings, the open node) lives as long as what it lent.
  filled.lease = std::shared_ptr<const void>(
      buffer.data, [ring = shared_from_this(), index](const void*) { ring->give_back(index); });
  return filled;
}

void BufferRing::stop() {
  const std::lock_guard lock(mutex_);
  if (!streaming_) return;
  streaming_ = false;
  auto type = static_cast<int>(device_->capture_type());
  device_->call(VIDIOC_STREAMOFF, &type);
}

int BufferRing::queued() const {
  const std::lock_guard lock(mutex_);
  return queued_;
}

}  // namespace sextant
