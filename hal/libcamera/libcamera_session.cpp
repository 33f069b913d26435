// SPDX-License-Identifier: Apache-2.0
#include "hal/libcamera/libcamera_session.h"

#include <fmt/format.h>

#include "hal/libcamera/camera_stream.h"
#include "hal/live/whole_jpeg.h"

namespace sextant {
namespace {

class LibcameraSession final : public StreamSession {
 public:
  explicit LibcameraSession(const StreamOptions& options)
      : stream_(CameraStream::start(options)), export_dma_buf_(options.export_dma_buf) {}
  ~LibcameraSession() override { stream_->stop(); }
  LibcameraSession(const LibcameraSession&) = delete;
  LibcameraSession& operator=(const LibcameraSession&) = delete;

  int wait_fd() const override { return stream_->wait_fd(); }
  // Requests that came back and wait for take() are no starvation: take() is called before this is asked.
  bool is_starved() const override { return stream_->queued() <= 0; }
  std::string description() const override { return stream_->description(); }

  Arrival take() override {
    Arrival arrival;
    const auto completed = stream_->take();
    if (!completed) {
      if (stream_->is_gone()) {
        arrival.kind = Arrival::Kind::kGone;
        arrival.reason = "it was unplugged";
      }
      return arrival;
    }
    arrival.device_sequence = completed->sequence;
    std::shared_ptr<const void> lease = stream_->lend(*completed);
    RawImage& image = arrival.image;
    image.format = stream_->format();
    image.width = static_cast<int>(stream_->configuration().size.width);
    image.height = static_cast<int>(stream_->configuration().size.height);
    const bool compressed = info_of(image.format).bits_per_pixel == 0;
    image.stride = compressed ? 0 : stream_->configuration().stride;
    image.bytes = completed->bytes;
    const bool whole =
        compressed ? is_whole_jpeg(image.bytes)
                   : image.bytes.size() >= image_bytes(image.format, image.width, image.height, image.stride);
    if (!completed->good || !whole) {
      arrival.kind = Arrival::Kind::kDamaged;
      arrival.reason = completed->good ? fmt::format("{} bytes", image.bytes.size()) : "flagged by libcamera";
      image = {};
      return arrival;
    }
    arrival.kind = Arrival::Kind::kImage;
    arrival.device_time = std::chrono::nanoseconds(completed->timestamp_ns);
    image.buffer = std::move(lease);
    image.dma_buf_fd = export_dma_buf_ ? completed->dma_buf_fd : -1;
    return arrival;
  }

 private:
  const std::shared_ptr<CameraStream> stream_;
  const bool export_dma_buf_;
};

}  // namespace

std::unique_ptr<StreamSession> open_libcamera_session(const StreamOptions& options) {
  return std::make_unique<LibcameraSession>(options);
}

}  // namespace sextant
