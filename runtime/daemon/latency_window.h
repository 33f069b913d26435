// SPDX-License-Identifier: Apache-2.0
// The last values of a quantity - one per frame - and what is typical and worst among them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sextant {

struct LatencySummary {
  double median = 0;
  double p95 = 0;
  double largest = 0;
};

/// Remembers a bounded number of values. Not thread-safe.
class LatencyWindow {
 public:
  static constexpr std::size_t kCapacity = 512;

  void add(double value) {
    if (values_.size() < kCapacity) {
      values_.push_back(value);
    } else {
      values_[next_] = value;
      next_ = (next_ + 1) % kCapacity;
    }
  }
  void clear() {
    values_.clear();
    next_ = 0;
  }
  std::size_t size() const { return values_.size(); }

  /// By the nearest rank; all zero without values.
  LatencySummary summary() const {
    if (values_.empty()) return {};
    std::vector<double> sorted = values_;
    std::sort(sorted.begin(), sorted.end());
    const auto rank = [&](double share) {
      const auto n = static_cast<double>(sorted.size());
      const auto index = static_cast<std::size_t>(std::max(1.0, std::min(n, share * n + 0.999999))) - 1;
      return sorted[index];
    };
    return {rank(0.5), rank(0.95), sorted.back()};
  }

 private:
  std::vector<double> values_;
  std::size_t next_ = 0;
};

}  // namespace sextant
