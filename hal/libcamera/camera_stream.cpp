// SPDX-License-Identifier: Apache-2.0
#include "hal/libcamera/camera_stream.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hal/libcamera/libcamera_controls.h"
#include "hal/live/stream_session.h"

namespace sextant {

namespace lc = libcamera;

namespace {

std::string what_it_offers(const lc::StreamConfiguration& configuration) {
  std::string text;
  for (const lc::PixelFormat& format : configuration.formats().pixelformats()) {
    const lc::SizeRange range = configuration.formats().range(format);
    for (const auto& [ours, theirs] : libcamera_api::formats()) {
      if (theirs == format)
        text += fmt::format("{}{} {} to {}", text.empty() ? "" : "; ", info_of(ours).name,
                            range.min.toString(), range.max.toString());
    }
  }
  return text.empty() ? "nothing that Sextant can decode" : text;
}

[[noreturn]] void fail(const std::string& where, const char* what, int error) {
  throw DeviceUnready(
      where, fmt::format("{}: {}", what, std::strerror(std::abs(error))),
      std::abs(error) == EBUSY ? "close the program that uses it" : "unplug it and plug it in again");
}

/// A camera's node that is open here was deleted. libcamera learns that from udev alone; stopping a camera
/// whose node went and that it believes to be there ends the process (an assertion of libcamera 0.0.3).
bool has_lost_node() {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), error).string();
    if (error || !target.ends_with(" (deleted)")) continue;
    for (const char* kind : {"/dev/video", "/dev/media", "/dev/v4l-subdev"}) {
      if (target.starts_with(kind)) return true;
    }
  }
  return false;
}

}  // namespace

std::shared_ptr<CameraStream> CameraStream::start(const StreamOptions& options) {
  const std::shared_ptr<CameraStream> stream(new CameraStream);
  stream->find(options.device);
  if (const int error = stream->camera_->acquire()) fail(options.device, "it cannot be used", error);
  stream->acquired_ = true;
  stream->configure(options);
  stream->map_buffers();
  stream->begin(options);
  return stream;
}

void CameraStream::find(const std::string& device) {
  std::string there;
  for (const auto& camera : system_.cameras()) {
    if (camera->id() == device || libcamera_api::model_of(*camera) == device) camera_ = camera;
    there += (there.empty() ? "there are " : ", ") + camera->id();
  }
  if (!camera_)
    throw DeviceUnready(
        device, "there is no such libcamera camera",
        there.empty() ? "there are none; is udev running, are libcamera-ipa and permissions there?" : there);
}

bool CameraStream::try_format(PixelFormat format, const StreamOptions& options, std::string& instead) {
  const auto& list = libcamera_api::formats();
  const auto entry = std::find_if(list.begin(), list.end(), [&](const auto& e) { return e.first == format; });
  if (entry == list.end()) return false;
  lc::StreamConfiguration& wanted = configuration_->at(0);
  const lc::Size size(static_cast<unsigned>(options.width), static_cast<unsigned>(options.height));
  wanted.pixelFormat = entry->second;
  wanted.size = size;
  wanted.bufferCount = static_cast<unsigned>(options.buffers);
  const auto status = configuration_->validate();
  if (status == lc::CameraConfiguration::Invalid) return false;
  // What validate() left there is what the camera will do.
  if (wanted.pixelFormat != entry->second || wanted.size != size) {
    instead = fmt::format(" (it gives {} {})", wanted.pixelFormat.toString(), wanted.size.toString());
    return false;
  }
  format_ = format;
  return true;
}

void CameraStream::configure(const StreamOptions& options) {
  configuration_ = libcamera_api::video_configuration(*camera_);
  if (!configuration_ || configuration_->empty())
    throw DeviceError(options.device, "it has no video stream", "choose another camera");
  const std::string offers = what_it_offers(configuration_->at(0));
  std::vector<PixelFormat> order;
  if (options.format == "auto") {
    for (const auto& entry : libcamera_api::formats()) order.push_back(entry.first);
  } else {
    order.push_back(*format_named(options.format));
  }
  std::string instead;
  const bool agreed =
      std::any_of(order.begin(), order.end(), [&](PixelFormat f) { return try_format(f, options, instead); });
  if (!agreed)
    throw DeviceError(
        options.device,
        fmt::format("it does not offer {} {}x{}{}", options.format, options.width, options.height, instead),
        "it offers " + offers);
  if (const int error = camera_->configure(configuration_.get()))
    fail(options.device, "cannot configure it", error);
  allocator_ = std::make_unique<lc::FrameBufferAllocator>(camera_);
  if (const int error = allocator_->allocate(configuration().stream()); error < 0)
    fail(options.device, "cannot get buffers", error);
}

void CameraStream::map_buffers() {
  const std::string& where = camera_->id();
  for (const auto& buffer : allocator_->buffers(configuration().stream())) {
    const auto& planes = buffer->planes();
    std::size_t begin = planes.front().offset;
    std::size_t end = begin;
    for (const lc::FrameBuffer::Plane& plane : planes) {
      // One after the other in one piece of memory, as all of Debian's drivers do.
      if (plane.fd.get() != planes.front().fd.get() || plane.offset != end)
        throw DeviceError(where, "its image planes lie apart", "choose a format of one plane (not NV12)");
      end = plane.offset + plane.length;
    }
    void* data = ::mmap(nullptr, end, PROT_READ, MAP_SHARED, planes.front().fd.get(), 0);
    if (data == MAP_FAILED) fail(where, "cannot map a buffer", errno);
    mappings_[buffer.get()] = {static_cast<std::byte*>(data), end, begin, planes.front().fd.get()};
  }
}

void CameraStream::begin(const StreamOptions& options) {
  lc::ControlList controls(camera_->controls());
  if (options.rate_hz > 0) libcamera_api::set_rate(controls, *camera_, options.rate_hz);
  add_libcamera_controls(controls, *camera_, options.controls, options.device);
  for (const auto& entry : mappings_) {
    requests_.push_back(camera_->createRequest());
    auto* buffer = const_cast<lc::FrameBuffer*>(entry.first);
    if (!requests_.back() || requests_.back()->addBuffer(configuration().stream(), buffer) != 0)
      fail(options.device, "cannot make a request", ENOMEM);
  }
  camera_->requestCompleted.connect(this, &CameraStream::on_completed);
  camera_->disconnected.connect(this, &CameraStream::on_disconnected);
  if (const int error = camera_->start(&controls)) fail(options.device, "cannot start streaming", error);
  running_ = true;
  for (const auto& request : requests_) {
    if (const int error = camera_->queueRequest(request.get()))
      fail(options.device, "cannot queue a request", error);
    const std::lock_guard lock(mutex_);
    ++queued_;
  }
}

CameraStream::~CameraStream() {
  stop();
  requests_.clear();
  for (const auto& entry : mappings_) ::munmap(entry.second.data, entry.second.mapped);
}

void CameraStream::stop() {
  {
    const std::lock_guard lock(run_mutex_);
    if (!acquired_) return;
    acquired_ = false;
    const std::shared_ptr<CameraStream> self = weak_from_this().lock();
    if (self && running_ && !is_gone() && has_lost_node()) {
      running_ = false;
      system_.abandon();
      // libcamera still writes there: kept for ever.
      [[maybe_unused]] const auto* for_ever = new std::shared_ptr<CameraStream>(self);
      return;
    }
    if (std::exchange(running_, false)) camera_->stop();
  }
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  camera_->release();
}

void CameraStream::on_completed(lc::Request* request) {
  {
    const std::lock_guard lock(mutex_);
    --queued_;
    completed_.push_back(request);
  }
  completion_.set();
}

void CameraStream::on_disconnected() {
  {
    const std::lock_guard lock(mutex_);
    gone_ = true;
  }
  completion_.set();
}

std::optional<CameraStream::Completed> CameraStream::take() {
  Completed completed;
  {
    const std::lock_guard lock(mutex_);
    if (completed_.empty()) {
      if (!gone_) completion_.clear();
      return std::nullopt;
    }
    completed.request = completed_.front();
    completed_.pop_front();
  }
  const auto& [stream, buffer] = *completed.request->buffers().begin();
  const lc::FrameMetadata& metadata = buffer->metadata();
  completed.good = completed.request->status() == lc::Request::RequestComplete &&
                   metadata.status == lc::FrameMetadata::FrameSuccess;
  completed.sequence = metadata.sequence;
  completed.timestamp_ns = metadata.timestamp;
  const Mapping& mapping = mappings_.at(buffer);
  std::size_t used = 0;
  // Of a picture in several planes all bytes count; of one plane those that were written.
  if (metadata.planes().size() == 1) {
    used = metadata.planes()[0].bytesused;
  } else {
    used = mapping.mapped - mapping.offset;
  }
  completed.bytes = {mapping.data + mapping.offset, std::min(used, mapping.mapped - mapping.offset)};
  completed.dma_buf_fd = mapping.fd;
  return completed;
}

std::shared_ptr<const void> CameraStream::lend(const Completed& completed) {
  return {completed.bytes.data(), [stream = shared_from_this(), request = completed.request](const void*) {
            stream->give_back(request);
          }};
}

void CameraStream::give_back(lc::Request* request) {
  const std::lock_guard lock(run_mutex_);
  if (!running_) return;
  request->reuse(lc::Request::ReuseBuffers);
  {
    const std::lock_guard count(mutex_);
    ++queued_;
  }
  // An error here is the camera's end, which the watchdog sees.
  camera_->queueRequest(request);
}

bool CameraStream::is_gone() const {
  const std::lock_guard lock(mutex_);
  return gone_;
}

int CameraStream::queued() const {
  const std::lock_guard lock(mutex_);
  return queued_;
}

std::string CameraStream::description() const {
  return fmt::format("{} {}, stride {}, {} buffers", info_of(format_).name, configuration().size.toString(),
                     configuration().stride, mappings_.size());
}

}  // namespace sextant
