// SPDX-License-Identifier: Apache-2.0
#include "hal/dds/dds_rgbd_source.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "hal/dds/dds_image_source.h"
#include "hal/dds/tf_listener.h"
#include "hal/wait_loop.h"
#include "idl/dds/type_hashes.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kSlice{50};  ///< how fast close() is answered while CameraInfo is waited for
constexpr milliseconds kPairSlice{500};

/// "camera/color/image_raw" -> "camera/color/camera_info".
std::string info_beside(const std::string& image_topic) {
  const std::size_t slash = image_topic.rfind('/');
  return (slash == std::string::npos ? "" : image_topic.substr(0, slash + 1)) + "camera_info";
}

/// What a CameraInfo says.
struct Info {
  CameraModel camera;
  std::string frame;
};

bool same(const CameraModel& a, const CameraModel& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
         a.cy == b.cy && a.distortion == b.distortion;
}

/// The latest valid CameraInfo of a topic.
class InfoReader {
 public:
  InfoReader(std::shared_ptr<const DdsParticipant> participant, const std::string& topic)
      : subscription_(std::move(participant), options(topic)) {}

  /// True where it changed.
  bool update(milliseconds timeout) {
    const std::optional<Info> before = info_;
    subscription_.wait_and_take(timeout, [&](const void* sample) {
      try {
        const auto& message = *static_cast<const CameraInfoMessage*>(sample);
        info_ = Info{camera_of(message, subscription_.topic()),
                     frame_of(message.header.frame_id, subscription_.topic())};
        refusal_.clear();
      } catch (const std::exception& error) {
        refusal_ = error.what();
      }
    });
    return info_ && (!before || !same(before->camera, info_->camera) || before->frame != info_->frame);
  }
  const std::optional<Info>& info() const { return info_; }
  std::string condition() const {
    if (!refusal_.empty()) return refusal_;
    return info_ ? "" : "no CameraInfo yet: " + subscription_.condition();
  }

 private:
  static SubscriptionOptions options(const std::string& topic) {
    SubscriptionOptions s;
    s.topic = topic;
    s.type = &sensor_msgs_msg_dds__CameraInfo__desc;
    s.type_hash = kTypeHashCameraInfo;
    return s;
  }
  Subscription subscription_;
  std::optional<Info> info_;
  std::string refusal_;
};

class DdsRgbdSource final : public FrameSource {
 public:
  explicit DdsRgbdSource(const DdsRgbdOptions& options)
      : options_(options), participant_(std::make_shared<DdsParticipant>(options.domain)) {
    for (const std::string& topic : {options.colour_topic, options.depth_topic}) {
      if (!is_ros_topic(topic))
        throw UsageError("\"" + topic + "\" is no image topic", "for example camera/color/image_raw");
    }
    if (options_.calibration) {
      start(*options_.calibration, options_.pairing.frame_id);
      return;
    }
    const auto topic = [](const std::string& given, const std::string& image) {
      return given.empty() ? info_beside(image) : given;
    };
    colour_info_.emplace(participant_, topic(options.colour_info_topic, options.colour_topic));
    depth_info_.emplace(participant_, topic(options.depth_info_topic, options.depth_topic));
    tf_.emplace(participant_, TfListenerOptions{});
  }

  std::optional<RgbdFrame> next(milliseconds timeout) override {
    return wait_for_result(timeout, closed_, [this](WaitClock::time_point deadline) {
      follow_calibration(std::min(left_until(deadline), kSlice));
      const std::shared_ptr<FrameSource> pairs = pairs_now();
      // In slices too: a CameraInfo may change while images of another size are refused.
      return pairs ? pairs->next(std::min(left_until(deadline), kPairSlice)) : std::nullopt;
    });
  }

  SourceState state() const override {
    if (closed_) return SourceState::kEnded;
    const std::shared_ptr<FrameSource> pairs = pairs_now();
    return pairs ? pairs->state() : SourceState::kWaiting;
  }

  std::string condition() const override {
    if (const std::shared_ptr<FrameSource> pairs = pairs_now()) return pairs->condition();
    const std::lock_guard lock(mutex_);
    return condition_;
  }

  SourceStatistics statistics() const override {
    const std::shared_ptr<FrameSource> pairs = pairs_now();
    const std::lock_guard lock(mutex_);
    SourceStatistics sum = before_;
    if (pairs) add(pairs->statistics(), sum);
    return sum;
  }

  void close() override {
    closed_ = true;
    if (const std::shared_ptr<FrameSource> pairs = pairs_now()) pairs->close();
  }

 private:
  std::shared_ptr<FrameSource> pairs_now() const {
    const std::lock_guard lock(mutex_);
    return pairs_;
  }

  static void add(const SourceStatistics& more, SourceStatistics& sum) {
    sum.delivered += more.delivered;
    sum.reconnects += more.reconnects;
    for (std::size_t i = 0; i < kDropReasons; ++i) sum.drops[i] += more.drops[i];
  }

  /// Looks for new CameraInfos and (re)starts pairing when both are there. Waits only while there is no pair.
  void follow_calibration(milliseconds timeout) {
    if (options_.calibration) return;
    const bool waiting = !pairs_now();
    const bool new_colour =
        colour_info_->update(waiting && !colour_info_->info() ? timeout : milliseconds(0));
    const bool new_depth = depth_info_->update(waiting && colour_info_->info() ? timeout : milliseconds(0));
    tf_->update();
    if (!waiting && !new_colour && !new_depth) return;
    std::string missing = colour_info_->condition();
    const std::string of_depth = depth_info_->condition();
    if (!of_depth.empty()) missing += (missing.empty() ? "" : "; ") + of_depth;
    if (!colour_info_->info() || !depth_info_->info()) {
      say(missing);
      return;
    }
    RgbdCalibration calibration;
    calibration.colour = colour_info_->info()->camera;
    calibration.depth = depth_info_->info()->camera;
    calibration.depth_is_registered = colour_info_->info()->frame == depth_info_->info()->frame &&
                                      same(calibration.colour, calibration.depth);
    if (!calibration.depth_is_registered) {
      if (options_.colour_from_depth) {
        calibration.colour_from_depth = *options_.colour_from_depth;
      } else {
        // Cameras are rigid: any age will do.
        const auto found = tf_->buffer().lookup(colour_info_->info()->frame, depth_info_->info()->frame,
                                                read_clocks().realtime, std::chrono::hours(24));
        if (!found) {
          say("where the depth camera is: " + found.error() +
              "; publish it on tf_static, or give a calibration file");
          return;
        }
        calibration.colour_from_depth = *found;
      }
    }
    try {
      start(calibration,
            options_.pairing.frame_id.empty() ? colour_info_->info()->frame : options_.pairing.frame_id);
    } catch (const InputError& error) {
      say(error.what());
    }
  }

  void start(const RgbdCalibration& calibration, const std::string& frame_id) {
    PairedSourceOptions pairing = options_.pairing;
    pairing.calibration = calibration;
    pairing.frame_id = frame_id;
    DdsImageOptions colour;
    colour.topic = options_.colour_topic;
    colour.kind = ImageKind::kColour;
    colour.stamp_on_arrival = options_.stamp_on_arrival;
    DdsImageOptions depth = colour;
    depth.topic = options_.depth_topic;
    depth.kind = ImageKind::kDepth;
    std::shared_ptr<FrameSource> fresh =
        pair_streams(open_dds_images(participant_, colour), open_dds_images(participant_, depth), pairing);
    std::shared_ptr<FrameSource> old;
    {
      const std::lock_guard lock(mutex_);
      if (pairs_) add(pairs_->statistics(), before_);
      old = std::exchange(pairs_, fresh);
      condition_.clear();
    }
    if (closed_) fresh->close();
  }

  void say(const std::string& condition) {
    const std::lock_guard lock(mutex_);
    condition_ = condition;
  }

  const DdsRgbdOptions options_;
  const std::shared_ptr<const DdsParticipant> participant_;
  // Of the thread that calls next().
  std::optional<InfoReader> colour_info_, depth_info_;
  std::optional<TfListener> tf_;

  std::atomic<bool> closed_{false};
  mutable std::mutex mutex_;
  std::shared_ptr<FrameSource> pairs_;  ///< shared: close() may come while it is replaced
  SourceStatistics before_;             ///< of earlier pairings
  std::string condition_;
};

}  // namespace

std::unique_ptr<FrameSource> open_dds_rgbd(const DdsRgbdOptions& options) {
  return std::make_unique<DdsRgbdSource>(options);
}

}  // namespace sextant
