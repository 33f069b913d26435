// SPDX-License-Identifier: Apache-2.0
// The trial behind `sextant tune`: learn a model with the point's parameters, search every image of a half,
// compare with the truth.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "offline/mesh/standing_object.h"
#include "offline/tune/tuning.h"

namespace sextant {

/// The images of a data set, dealt out in turn to the two halves: those with the object by themselves, those
/// without by themselves.
struct ImageHalves {
  std::vector<BopImage> training, held_out;
};
ImageHalves split_images(const std::vector<BopImage>& images, int object_id);

struct DetectorTrialOptions {
  StandingObject object;
  std::string mesh_name;
  int object_id = 1;
  TuneParameters base;
  ImageHalves images;
  std::filesystem::path folder;  ///< learnt models are kept in folder/models for points that share one
  int threads = 0;               ///< of learning and searching; 0: all cores
};

/// Callable; copies share their state. Throws InputError where the training half holds no such object.
Trial detector_trial(DetectorTrialOptions options);

}  // namespace sextant
