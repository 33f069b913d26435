// SPDX-License-Identifier: Apache-2.0
// What one stage of the pipeline hands to the next: a bounded queue that drops the oldest item, never the
// newest.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace sextant {

/// One producer, one consumer.
template <typename Item>
class NewestQueue {
 public:
  explicit NewestQueue(std::size_t capacity) : capacity_(capacity) {}

  /// Adds an item; when the queue is full, the oldest is dropped and counted. Ignored after an end.
  void push(Item item) {
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    if (items_.size() >= capacity_) {
      items_.pop_front();
      ++dropped_;
    }
    items_.push_back(std::move(item));
    changed_.notify_all();
  }

  /// Adds an item when there is room for it, so that none is dropped. Ignored after an end.
  void push_when_room(Item item) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || items_.size() < capacity_; });
    if (ended_) return;
    items_.push_back(std::move(item));
    changed_.notify_all();
  }

  /// Waits until the consumer has nothing to do and asks for an item; false after an end.
  bool wait_for_demand() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || (items_.empty() && demanded_); });
    return !ended_;
  }

  /// Waits for the oldest item; nothing when the queue has ended and is empty.
  std::optional<Item> pop() {
    std::unique_lock lock(mutex_);
    demanded_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return ended_ || !items_.empty(); });
    demanded_ = false;
    if (items_.empty()) return std::nullopt;
    Item item = std::move(items_.front());
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  /// No more items will come; those that wait are still handed out.
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    changed_.notify_all();
  }

  /// Ends and forgets those that wait.
  void abort() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    items_.clear();
    changed_.notify_all();
  }

  std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Item> items_;
  std::uint64_t dropped_ = 0;
  bool demanded_ = false;
  bool ended_ = false;
};

}  // namespace sextant
