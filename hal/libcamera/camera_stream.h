// SPDX-License-Identifier: Apache-2.0
// A configured, running libcamera stream with its requests and mapped buffers. Lives as long as the session
// or any image that was lent from it.
#pragma once

#include <sys/types.h>

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <span>

#include "hal/libcamera/camera_system.h"
#include "hal/live/stream_options.h"
#include "hal/live/wake_event.h"

namespace sextant {

class CameraStream : public std::enable_shared_from_this<CameraStream> {
 public:
  /// A request that came back.
  struct Completed {
    libcamera::Request* request = nullptr;
    bool good = false;
    std::uint32_t sequence = 0;
    std::uint64_t timestamp_ns = 0;
    std::span<const std::byte> bytes;
    int dma_buf_fd = -1;
  };

  /// Finds, configures and starts the camera. Throws as open_libcamera_session().
  static std::shared_ptr<CameraStream> start(const StreamOptions& options);
  ~CameraStream();
  CameraStream(const CameraStream&) = delete;
  CameraStream& operator=(const CameraStream&) = delete;

  std::optional<Completed> take();
  /// Hands the request back to the camera when the last copy goes; good for the bytes until then.
  std::shared_ptr<const void> lend(const Completed& completed);
  void stop();

  bool is_gone() const;
  int wait_fd() const { return completion_.fd(); }
  int queued() const;
  PixelFormat format() const { return format_; }
  const libcamera::StreamConfiguration& configuration() const { return configuration_->at(0); }
  std::string description() const;

 private:
  struct Mapping {
    std::byte* data = nullptr;
    std::size_t mapped = 0;
    std::size_t offset = 0;
    int fd = -1;
  };

  CameraStream() = default;
  void find(const std::string& device);
  void configure(const StreamOptions& options);
  bool try_format(PixelFormat format, const StreamOptions& options, std::string& instead);
  void map_buffers();
  void begin(const StreamOptions& options);
  void give_back(libcamera::Request* request);
  void on_completed(libcamera::Request* request);
  void on_disconnected();

  // Destroyed in reverse order: the manager last.
  CameraSystem system_;
  std::shared_ptr<libcamera::Camera> camera_;
  std::unique_ptr<libcamera::CameraConfiguration> configuration_;
  std::unique_ptr<libcamera::FrameBufferAllocator> allocator_;
  std::map<const libcamera::FrameBuffer*, Mapping> mappings_;
  std::vector<std::unique_ptr<libcamera::Request>> requests_;
  PixelFormat format_ = PixelFormat::kYuyv;
  bool acquired_ = false;

  const WakeEvent completion_;
  mutable std::mutex run_mutex_;  // queueing against stopping
  bool running_ = false;
  mutable std::mutex mutex_;  // what libcamera's thread tells
  std::deque<libcamera::Request*> completed_;
  int queued_ = 0;
  bool gone_ = false;
};

}  // namespace sextant
