// SPDX-License-Identifier: Apache-2.0
// What every source of hal/ can say about itself: whether frames can come, and which were lost and why.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <string>

namespace sextant {

/// Why next() gave no frame.
enum class SourceState : std::uint8_t {
  kRunning,  ///< nothing yet within the timeout
  kWaiting,  ///< the device is away or silent; the source tries to get it back
  kEnded,    ///< no more frames will come
};

/// Why a frame was not handed out.
enum class DropReason : std::uint8_t {
  kLost,        ///< never reached us: a gap in the device's numbering
  kDamaged,     ///< the device flagged it, or it was torn, short or undecodable
  kStale,       ///< too old when it could have been handed out
  kSuperseded,  ///< a newer one was there when the consumer asked
  kBadTime,     ///< no believable capture time
  kUnpaired,    ///< colour without its depth, or depth without its colour
  kRefused,     ///< well-formed but not as configured (size, encoding, calibration)
  kUnwritten,   ///< a recorder could not write it
};
inline constexpr std::size_t kDropReasons = 8;
/// "lost", "damaged", ...
const char* name_of(DropReason reason);

/// What a source did so far.
struct SourceStatistics {
  std::uint64_t delivered = 0;
  std::uint64_t reconnects = 0;  ///< times that the device came back
  std::array<std::uint64_t, kDropReasons> drops{};

  std::uint64_t& drop(DropReason reason) { return drops[static_cast<std::size_t>(reason)]; }
  std::uint64_t drop(DropReason reason) const { return drops[static_cast<std::size_t>(reason)]; }
  /// For any reason.
  std::uint64_t dropped() const { return std::accumulate(drops.begin(), drops.end(), std::uint64_t{0}); }
};

/// "3 lost, 1 damaged": the reasons with a count, or "none".
std::string describe_drops(const SourceStatistics& statistics);

}  // namespace sextant
