// SPDX-License-Identifier: Apache-2.0
// Data sets of rendered table scenes with a real sensor's faults: what tests, demos and measurements use
// where no labelled recordings exist.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "offline/mesh/standing_object.h"
#include "offline/synthesize/scene.h"
#include "runtime/model/object_model.h"

namespace sextant {

/// An object to put on tables.
struct SynthesisTarget {
  int object_id = 1;
  StandingObject object;
};

struct SynthesisOptions {
  std::filesystem::path output;    ///< folder of the data set
  int images = 20;                 ///< 1..1000000; targets take turns
  int targets_per_image = 1;       ///< different objects at once, 1..number of targets
  std::string sensor = "kinect1";  ///< see depth_sensor()
  std::uint64_t seed = 1;          ///< image k depends on seed and k alone
  SceneOptions scene;
};

struct SynthesisSummary {
  int images = 0;
  int instances = 0;
  double mean_visible_fraction = 0;
};

/// Writes the data set (scene 1, images from 0). progress(done, total) is called after each image.
/// Throws UsageError, InputError, DeviceError.
SynthesisSummary synthesize_dataset(const std::vector<SynthesisTarget>& targets,
                                    const SynthesisOptions& options,
                                    const std::function<void(std::size_t, std::size_t)>& progress);

/// An object from a compiled model: its simplified mesh, grey, flat shaded.
StandingObject standing_object_of(const ObjectModel& model);

}  // namespace sextant
