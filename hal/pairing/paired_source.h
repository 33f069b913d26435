// SPDX-License-Identifier: Apache-2.0
// A colour stream and a depth stream as one source of RGB-D frames: decoded, paired in time, registered.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "hal/frame_source.h"
#include "hal/image_source.h"
#include "hal/pairing/frame_composer.h"
#include "hal/pairing/stream_synchroniser.h"
#include "hal/pixels/decode.h"

namespace sextant {

struct PairedSourceOptions {
  RgbdCalibration calibration;
  ComposerOptions composer;
  DepthScale depth_scale;
  SynchroniserOptions synchroniser;
  /// A pair older than this, by its colour image, when it could be handed out is dropped and counted as
  /// stale; 0: never.
  std::chrono::milliseconds max_age{100};
  std::string frame_id;  ///< given to every frame
  /// The clock for ages; tests inject theirs.
  std::function<MonotonicTime()> now = [] { return read_clocks().monotonic; };
};

/// Starts one thread per stream, which waits for its images and decodes them; registration happens in the
/// thread that calls next(). The newest pair is handed out, older ones are counted as superseded; a frame
/// carries the time and the sequence number of its colour image, and is always newer than the one before.
///
/// statistics(): delivered pairs; unpaired images of both streams; images of another size than calibrated
/// (refused) and undecodable ones (damaged); reconnects and drops of the two streams themselves are added.
/// state(): kWaiting while one of them waits (condition() says which and why), kEnded when one has ended.
/// next() throws DeviceError when a stream has died for good. Throws InputError for an impossible
/// calibration.
std::unique_ptr<FrameSource> pair_streams(std::unique_ptr<ImageSource> colour,
                                          std::unique_ptr<ImageSource> depth, PairedSourceOptions options);

}  // namespace sextant
