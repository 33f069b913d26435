// SPDX-License-Identifier: Apache-2.0
// Ownership of one Cyclone DDS handle (C API), and its error codes as DeviceError.
#pragma once

#include <dds/dds.h>

#include <string>
#include <utility>

namespace sextant {

/// Throws DeviceError("DDS", "<doing>: <reason>", advice) when `code` is an error; else returns it.
dds_return_t check_dds(dds_return_t code, const std::string& doing, const std::string& advice = "");

/// Owns an entity and everything that was created under it. Deleting a participant deletes its children.
class DdsEntity {
 public:
  DdsEntity() = default;
  /// Takes what a dds_create_... call returned; throws DeviceError when that is an error.
  DdsEntity(dds_entity_t handle, const std::string& doing, const std::string& advice = "")
      : handle_(check_dds(handle, doing, advice)) {}
  ~DdsEntity() { reset(); }
  DdsEntity(DdsEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept {
    if (this != &other) {
      reset();
      handle_ = std::exchange(other.handle_, 0);
    }
    return *this;
  }
  DdsEntity(const DdsEntity&) = delete;
  DdsEntity& operator=(const DdsEntity&) = delete;

  dds_entity_t get() const { return handle_; }
  explicit operator bool() const { return handle_ > 0; }
  void reset() {
    if (handle_ > 0) dds_delete(handle_);
    handle_ = 0;
  }

 private:
  dds_entity_t handle_ = 0;
};

/// The participant of a domain (0..230). Throws DeviceError, with advice, where there is no network for it.
DdsEntity create_participant(unsigned domain);

}  // namespace sextant
