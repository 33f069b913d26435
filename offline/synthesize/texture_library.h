// SPDX-License-Identifier: Apache-2.0
// The textures of one data set. Painting one takes longer than an image may: a seed stands for a fixed stock
// of them, painted when first used, and every use takes another piece, turned and tinted.
#pragma once

#include <map>
#include <mutex>
#include <opencv2/core.hpp>
#include <utility>

#include "offline/synthesize/random.h"

namespace sextant {

enum class TextureKind { kTable, kFloor, kWall, kPrint, kPage };

/// Safe to share between threads. What pick() returns depends on the library's seed and the state of
/// `random` alone.
class TextureLibrary {
 public:
  /// Pieces of each kind.
  static constexpr int kStock = 24;

  explicit TextureLibrary(std::uint64_t seed) : seed_(seed) {}

  /// A random piece, CV_8UC3 RGB. Prints and pages come whole and upright; the others cut, flipped, turned.
  cv::Mat pick(TextureKind kind, Random& random);

 private:
  cv::Mat painted(TextureKind kind, int number);

  std::uint64_t seed_;
  std::mutex mutex_;
  std::map<std::pair<TextureKind, int>, cv::Mat> stock_;
};

}  // namespace sextant
