// SPDX-License-Identifier: Apache-2.0
// The calibration of a colour and a depth camera that belong together, as a YAML file:
//
//   colour: {width: 640, height: 480, fx: 525, fy: 525, cx: 319.5, cy: 239.5, distortion: [k1, k2, p1, p2,
//   k3]} depth: {width: 640, height: 480, fx: 580, fy: 580, cx: 320, cy: 240, metres_per_unit: 0.001}
//   colour_from_depth:            # where the depth camera is in the colour camera
//     translation_m: [-0.025, 0, 0]
//     rotation: [1, 0, 0,  0, 1, 0,  0, 0, 1]   # rows; may be left out
//   tolerance_ms: 17              # of capture times of one pair
//
// `depth: {registered: true, metres_per_unit: 0.001}` without colour_from_depth where the device has moved
// the depth into the colour camera already. Also under depth: nearest_m, farthest_m, encoding: linear |
// kinect (raw disparity of a first Kinect). shared_sequence: true where both streams count the same frames.
#pragma once

#include <filesystem>

#include "hal/pairing/frame_composer.h"
#include "hal/pairing/stream_synchroniser.h"
#include "hal/pixels/decode.h"

namespace sextant {

struct RigFile {
  RgbdCalibration calibration;
  DepthScale depth_scale;
  SynchroniserOptions synchroniser;
};

/// Throws InputError naming file, line and key for anything missing, unknown or out of range.
RigFile read_rig_file(const std::filesystem::path& file);

}  // namespace sextant
