// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/frame_reel.h"

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

class BopReel final : public FrameReel {
 public:
  explicit BopReel(BopDataset dataset) : images_(std::move(dataset.images)) {}
  std::size_t size() const override { return images_.size(); }
  std::optional<CaptureStamp> captured(std::size_t) const override { return std::nullopt; }
  RgbdFrame load(std::size_t i) const override { return load_frame(images_[i]); }

 private:
  std::vector<BopImage> images_;
};

}  // namespace

std::unique_ptr<FrameReel> open_bop_reel(const ReelOptions& options) {
  BopDataset dataset = open_bop_dataset(options.dataset, options.split, options.scene);
  if (options.image >= 0) {
    std::erase_if(dataset.images, [&](const BopImage& image) { return image.image_id != options.image; });
    if (dataset.images.empty()) {
      throw InputError((options.dataset / options.split).string(),
                       "holds no image " + std::to_string(options.image),
                       "image numbers are the keys of scene_camera.json");
    }
  }
  return std::make_unique<BopReel>(std::move(dataset));
}

std::unique_ptr<FrameReel> open_reel(const ReelOptions& options) {
  if (is_tum_folder(options.dataset)) return open_tum_reel(options);
  if (is_recording(options.dataset, options.split)) return open_recording_reel(options);
  return open_bop_reel(options);
}

}  // namespace sextant
