// SPDX-License-Identifier: Apache-2.0
// Plays a BOP data set as if it were a camera: the source behind the demo, tests and soaks.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "hal/frame_source.h"

namespace sextant {

/// What to play and how.
struct BopSourceOptions {
  std::filesystem::path dataset;  ///< folder that holds models/ and the split
  std::string split = "test";
  int scene = -1;        ///< this scene only; -1: all, in numeric order
  int image = -1;        ///< this image number only; -1: all, in numeric order
  double rate_hz = 0;    ///< frames per second, 0..10000; 0: as fast as they are asked for
  bool loop = false;     ///< begin again after the last one
  std::string frame_id;  ///< given to every frame
};

/// Opens the data set's lists (not the images). Frames are never skipped: a consumer that is late gets the
/// next one at once and the pace starts again from there. captured_at is the wall clock when a frame is
/// handed over, sequence counts from 0. An image that cannot be read makes next() throw InputError; the call
/// after it goes on with the following image. Throws InputError / UsageError.
std::unique_ptr<FrameSource> open_bop_source(const BopSourceOptions& options);

}  // namespace sextant
