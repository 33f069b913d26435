// SPDX-License-Identifier: Apache-2.0
// Recordings of ours as a reel.
#include <fmt/format.h>

#include "hal/image/image_file.h"
#include "hal/playback/bop_dataset.h"
#include "hal/playback/depth_image.h"
#include "hal/playback/frame_reel.h"
#include "hal/playback/recording_format.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

struct Entry {
  RecordedFrame recorded;
  fs::path colour, depth;
};

class RecordingReel final : public FrameReel {
 public:
  RecordingReel(std::vector<Entry> entries, std::vector<std::string> remarks)
      : entries_(std::move(entries)), remarks_(std::move(remarks)) {}

  std::size_t size() const override { return entries_.size(); }

  std::optional<CaptureStamp> captured(std::size_t i) const override {
    const RgbdFrame& f = entries_[i].recorded.frame;
    return CaptureStamp{f.captured_monotonic, f.captured_at};
  }

  RgbdFrame load(std::size_t i) const override {
    const Entry& entry = entries_[i];
    RgbdFrame frame = entry.recorded.frame;
    frame.colour = read_colour_image(entry.colour);
    frame.axial_depth_m = depth_in_metres(read_depth_image(entry.depth), entry.recorded.depth_scale_mm);
    require_same_size(frame.colour, entry.colour, frame.axial_depth_m, entry.depth);
    if (frame.colour.cols != frame.camera.width || frame.colour.rows != frame.camera.height) {
      throw InputError(entry.colour.string(), fmt::format("has another size than {} says", kRecordingList));
    }
    return frame;
  }

  std::vector<std::string> remarks() const override { return remarks_; }

 private:
  std::vector<Entry> entries_;
  std::vector<std::string> remarks_;
};

}  // namespace

bool is_recording(const fs::path& folder, const std::string& split) {
  std::error_code error;
  for (fs::directory_iterator it(folder / split, error), end; !error && it != end; it.increment(error)) {
    if (fs::exists(it->path() / kRecordingList, error)) return true;
  }
  return false;
}

std::unique_ptr<FrameReel> open_recording_reel(const ReelOptions& options) {
  std::vector<Entry> entries;
  std::vector<std::string> remarks;
  for (const auto& [scene, folder] : list_scenes(options.dataset / options.split, options.scene)) {
    std::error_code error;
    if (!fs::exists(folder / kRecordingList, error)) continue;
    RecordingList list = read_recording_list(folder / kRecordingList);
    for (RecordedFrame& recorded : list.frames) {
      if (options.image >= 0 && recorded.image_id != options.image) continue;
      const std::string name = fmt::format("{:06}.png", recorded.image_id);
      recorded.frame.scene_id = scene;
      recorded.frame.image_id = recorded.image_id;
      entries.push_back({std::move(recorded), folder / "rgb" / name, folder / "depth" / name});
    }
    for (const std::string& remark : list.remarks)
      remarks.push_back(fmt::format("scene {}: {}", scene, remark));
  }
  if (entries.empty()) {
    throw InputError((options.dataset / options.split).string(), "holds no recorded frame of that choice",
                     "check the scene and image numbers");
  }
  return std::make_unique<RecordingReel>(std::move(entries), std::move(remarks));
}

}  // namespace sextant
