// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/v4l2_source.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>

#include "hal/live/live_source.h"
#include "hal/live/whole_jpeg.h"
#include "hal/v4l2/buffer_ring.h"
#include "hal/v4l2/v4l2_controls.h"
#include "hal/v4l2/v4l2_modes.h"

namespace sextant {
namespace {

class V4l2Session final : public StreamSession {
 public:
  V4l2Session(const StreamOptions& options, const DevicePlaces& places, const std::string& where)
      : device_(open_v4l2_device(options.device, places)),
        format_(agree_on_format(*device_, options, where)) {
    set_controls(*device_, options.controls, where);
    ring_ = BufferRing::start(device_, options.buffers, options.export_dma_buf, where);
  }
  ~V4l2Session() override { ring_->stop(); }
  V4l2Session(const V4l2Session&) = delete;
  V4l2Session& operator=(const V4l2Session&) = delete;

  int wait_fd() const override { return device_->fd(); }
  bool is_starved() const override { return ring_->queued() == 0; }

  std::string description() const override {
    return fmt::format("{} {}x{}{}, {} buffers, {}", info_of(format_.format).name, format_.width,
                       format_.height,
                       format_.rate_hz > 0 ? fmt::format(" at {:.4g} Hz", format_.rate_hz) : "",
                       ring_->size(), device_->node());
  }

  Arrival take() override {
    BufferRing::Filled filled = ring_->take();
    Arrival arrival;
    if (filled.error == EAGAIN) {
      if (queue_is_broken()) gone(arrival, "its queue broke or it went away");
      return arrival;
    }
    if (filled.error != 0) {
      gone(arrival, error_text(filled.error));
      return arrival;
    }
    arrival.device_sequence = filled.info.sequence;
    if ((filled.info.flags & V4L2_BUF_FLAG_ERROR) != 0) return damaged(arrival, "flagged by the driver");
    if (!is_whole(filled.bytes)) return damaged(arrival, fmt::format("{} bytes", filled.bytes.size()));
    arrival.kind = Arrival::Kind::kImage;
    arrival.device_time = std::chrono::seconds(filled.info.timestamp.tv_sec) +
                          std::chrono::microseconds(filled.info.timestamp.tv_usec);
    RawImage& image = arrival.image;
    image.format = format_.format;
    image.width = format_.width;
    image.height = format_.height;
    image.stride = format_.stride;
    image.bytes = filled.bytes;
    image.buffer = std::move(filled.lease);
    image.dma_buf_fd = filled.dma_buf_fd;
    return arrival;
  }

 private:
  /// poll(2) says so even when no buffer tells.
  bool queue_is_broken() const {
    pollfd polled{device_->fd(), POLLIN, 0};
    return ::poll(&polled, 1, 0) > 0 && (polled.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
  }

  bool is_whole(std::span<const std::byte> bytes) const {
    if (info_of(format_.format).bits_per_pixel == 0) return is_whole_jpeg(bytes);
    return bytes.size() >= image_bytes(format_.format, format_.width, format_.height, format_.stride);
  }

  static void gone(Arrival& arrival, std::string reason) {
    arrival.kind = Arrival::Kind::kGone;
    arrival.reason = std::move(reason);
  }

  static Arrival damaged(Arrival& arrival, std::string reason) {
    arrival.kind = Arrival::Kind::kDamaged;
    arrival.reason = std::move(reason);
    return arrival;
  }

  const std::shared_ptr<const V4l2Device> device_;
  const AgreedFormat format_;
  std::shared_ptr<BufferRing> ring_;
};

}  // namespace

std::unique_ptr<ImageSource> open_v4l2_source(const StreamOptions& options, const DevicePlaces& places) {
  check_stream_options(options);
  const std::string name = "v4l2 " + options.device;
  return make_live_source(name, options,
                          [=] { return std::make_unique<V4l2Session>(options, places, options.device); });
}

}  // namespace sextant
