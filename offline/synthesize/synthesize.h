// SPDX-License-Identifier: Apache-2.0
// Data sets of rendered table scenes with a real sensor's faults: what tests, demos and measurements use
// where no labelled recordings exist.
#pragma once

#include <filesystem>
#include <functional>

#include "offline/synthesize/synthesizer.h"
#include "runtime/model/object_model.h"

namespace sextant {

struct SynthesisOptions : ImageOptions {
  std::filesystem::path output;  ///< folder of the data set
  int threads = 0;               ///< 0: all cores; the images are the same for any number
};

struct SynthesisSummary {
  int images = 0;  ///< negatives included
  int instances = 0;
  double mean_visible_fraction = 0;
};

/// Writes the data set (scene 1, images from 0; negatives last). progress(done, total) is called after each
/// image, by one thread at a time. Throws UsageError, InputError, DeviceError.
SynthesisSummary synthesize_dataset(const std::vector<SynthesisTarget>& targets,
                                    const std::vector<StandingObject>& distractors,
                                    const SynthesisOptions& options,
                                    const std::function<void(std::size_t, std::size_t)>& progress);

/// An object from a compiled model: its simplified mesh, grey, flat shaded.
StandingObject standing_object_of(const ObjectModel& model);

}  // namespace sextant
