// SPDX-License-Identifier: Apache-2.0
// The lists of a TUM RGB-D folder (Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM
// systems"): rgb.txt and depth.txt with lines "timestamp filename", depth values of 1/5000 m.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hal/playback/single_frame.h"
#include "runtime/frame/capture_time.h"

namespace sextant {

/// A colour image and the depth image nearest to it in time.
struct TumPair {
  CaptureTime captured_at;  ///< of the colour image
  std::filesystem::path colour, depth;
};

struct TumDataset {
  CameraFile camera;  ///< width and height 640 x 480 unless camera.yaml says otherwise
  std::vector<TumPair> pairs;
  std::vector<std::string> remarks;
};

/// Reads the lists. Images belong together when each is the other's nearest and they are at most 20 ms apart,
/// as the benchmark's own associate.py does. The calibration is camera.yaml in the folder (the form of
/// `sextant detect --camera`), else the published one of the sequence's camera where the folder's name says
/// which (freiburg1, freiburg2, freiburg3). Throws InputError for missing, damaged or unsorted lists, paths
/// that leave the folder, no pair at all, and an unknown camera.
TumDataset open_tum_dataset(const std::filesystem::path& folder);

}  // namespace sextant
