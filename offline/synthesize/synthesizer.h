// SPDX-License-Identifier: Apache-2.0
// Single images of rendered table scenes with a real sensor's faults, with their ground truth; nothing is
// written. What synthesize_dataset() writes, and what learning may draw its statistics from.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "offline/dataset/bop_writer.h"
#include "offline/mesh/standing_object.h"
#include "offline/synthesize/scene.h"

namespace sextant {

/// An object to put on tables.
struct SynthesisTarget {
  int object_id = 1;
  StandingObject object;
};

/// What the images show.
struct ImageOptions {
  int images = 20;                           ///< with targets, numbers 0..images-1; the targets take turns
  int negatives = 0;                         ///< images without any, numbered after them
  int targets_per_image = 1;                 ///< different objects at once, 1..number of targets
  Range instances{1, 1};                     ///< of each of them
  std::string sensor = "kinect1";            ///< see depth_sensor()
  std::optional<double> misregistration_px;  ///< rms shift of depth against colour; empty: the sensor's
  double no_depth_share = 0;                 ///< of the instances that give (nearly) no depth
  std::uint64_t seed = 1;                    ///< image k depends on seed and k alone
  SceneOptions scene;
};

struct SyntheticImage {
  RgbdFrame frame;
  std::vector<BopInstance> instances;
};

/// Throws UsageError where the options make no sense.
void check_image_options(const std::vector<SynthesisTarget>& targets, const ImageOptions& options);

/// Belongs to the thread that made it (a Renderer does). `targets`, `distractors` (meshes that may stand
/// around without being labelled) and `textures` must outlive it.
class Synthesizer {
 public:
  /// Throws UsageError (unknown sensor), DeviceError (no renderer).
  Synthesizer(const std::vector<SynthesisTarget>& targets, const std::vector<StandingObject>& distractors,
              const ImageOptions& options, TextureLibrary& textures);
  ~Synthesizer();
  Synthesizer(const Synthesizer&) = delete;
  Synthesizer& operator=(const Synthesizer&) = delete;

  /// Image `number` of the data set. Throws UsageError where no scene obeys the options.
  SyntheticImage make(int number);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
