// SPDX-License-Identifier: Apache-2.0
// Messages whose memory a test owns, and writers for them.
#pragma once

#include <dds/dds.h>

#include <string>
#include <vector>

#include "hal/dds/image_message.h"
#include "runtime/frame/capture_time.h"

namespace sextant {

/// An image of `bytes_per_pixel`, with `padding` bytes at the end of each line; stamped now.
class TestImage {
 public:
  TestImage(const std::string& encoding, unsigned width, unsigned height, unsigned bytes_per_pixel,
            unsigned padding)
      : encoding_(encoding), bytes_per_pixel_(bytes_per_pixel) {
    message_.width = width;
    message_.height = height;
    message_.step = width * bytes_per_pixel + padding;
    data_.resize(std::size_t{message_.step} * height);
    message_.encoding = encoding_.data();
    message_.header.frame_id = frame_.data();
    message_.data._buffer = data_.data();
    message_.data._length = static_cast<std::uint32_t>(data_.size());
    message_.data._maximum = message_.data._length;
    stamp(read_clocks().realtime);
  }
  TestImage(const TestImage&) = delete;
  TestImage& operator=(const TestImage&) = delete;

  /// Every pixel these bytes.
  void fill(const std::vector<int>& pixel) {
    for (unsigned y = 0; y < message_.height; ++y) {
      for (unsigned x = 0; x < message_.width; ++x) {
        for (unsigned k = 0; k < bytes_per_pixel_; ++k) {
          data_[std::size_t{y} * message_.step + x * bytes_per_pixel_ + k] =
              static_cast<std::uint8_t>(pixel[k]);
        }
      }
    }
  }
  void stamp(CaptureTime at) {
    const auto ns = at.time_since_epoch().count();
    message_.header.stamp.sec = static_cast<std::int32_t>(ns / 1'000'000'000);
    message_.header.stamp.nanosec = static_cast<std::uint32_t>(ns % 1'000'000'000);
  }
  ImageMessage& message() { return message_; }

 private:
  std::string encoding_;
  std::string frame_ = "camera_frame";
  unsigned bytes_per_pixel_;
  std::vector<std::uint8_t> data_;
  ImageMessage message_{};
};

class TestInfo {
 public:
  TestInfo(unsigned width, unsigned height, double focal, std::string frame = "camera_frame")
      : frame_(std::move(frame)) {
    message_.width = width;
    message_.height = height;
    message_.k[0] = focal;
    message_.k[2] = 0.5 * width;
    message_.k[4] = focal;
    message_.k[5] = 0.5 * height;
    message_.k[8] = 1;
    message_.header.frame_id = frame_.data();
    set_distortion("plumb_bob", {});
  }
  TestInfo(const TestInfo&) = delete;
  TestInfo& operator=(const TestInfo&) = delete;

  void set_distortion(const std::string& model, std::vector<double> d) {
    model_ = model;
    d_ = std::move(d);
    message_.distortion_model = model_.data();
    message_.d._buffer = d_.data();
    message_.d._length = static_cast<std::uint32_t>(d_.size());
    message_.d._maximum = message_.d._length;
  }
  CameraInfoMessage& message() { return message_; }

 private:
  std::string frame_, model_;
  std::vector<double> d_;
  CameraInfoMessage message_{};
};

/// A reliable writer of one topic, as a ROS 2 node would have it.
class TestWriter {
 public:
  TestWriter(dds_entity_t participant, const dds_topic_descriptor_t* type, const std::string& topic,
             bool latched = false) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
    dds_qset_durability(qos, latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
    topic_ = dds_create_topic(participant, type, ("rt/" + topic).c_str(), nullptr, nullptr);
    writer_ = dds_create_writer(participant, topic_, qos, nullptr);
    dds_delete_qos(qos);
  }
  ~TestWriter() {
    dds_delete(writer_);
    dds_delete(topic_);
  }
  TestWriter(const TestWriter&) = delete;
  TestWriter& operator=(const TestWriter&) = delete;
  bool good() const { return writer_ > 0; }
  void write(const void* sample) { dds_write(writer_, sample); }
  int matched() const {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_, &status);
    return static_cast<int>(status.current_count);
  }

 private:
  dds_entity_t topic_ = 0;
  dds_entity_t writer_ = 0;
};

}  // namespace sextant
