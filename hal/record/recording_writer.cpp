// SPDX-License-Identifier: Apache-2.0
#include "hal/record/recording_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <system_error>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "hal/record/append_file.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "this folder cannot be made (" + error.message() + ")");
}

/// The number after the last scene there.
int next_scene(const fs::path& split_folder) {
  int last = 0;
  std::error_code error;
  for (fs::directory_iterator it(split_folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (!name.empty() && name.size() <= 9 && name.find_first_not_of("0123456789") == std::string::npos) {
      last = std::max(last, std::stoi(name));
    }
  }
  return last + 1;
}

/// 16-bit values of a depth image; what does not fit is 0 and counted.
cv::Mat raw_depth(const cv::Mat& metres, double scale_mm, std::uint64_t& out_of_range) {
  cv::Mat raw(metres.size(), CV_16UC1);
  const auto to_raw = static_cast<float>(1000.0 / scale_mm);
  for (int y = 0; y < metres.rows; ++y) {
    const auto* in = metres.ptr<float>(y);
    auto* out = raw.ptr<std::uint16_t>(y);
    for (int x = 0; x < metres.cols; ++x) {
      const float value = in[x] * to_raw + 0.5F;
      const bool fits = value >= 1.0F && value < 65536.0F;
      out[x] = fits ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
      out_of_range += !fits && in[x] > 0 ? 1U : 0U;
    }
  }
  return raw;
}

void write_list(const fs::path& file, const std::map<int, std::string>& lines) {
  std::string text = "{";
  for (const auto& [image, line] : lines) {
    text += fmt::format("{}\n \"{}\": {}", text.size() > 1 ? "," : "", image, line);
  }
  text += "\n}\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

}  // namespace

struct RecordingWriter::Impl {
  RecordingOptions options;
  fs::path scene;
  std::optional<AppendFile> list;
  int next_image = 0;
  std::uint64_t bytes = 0;
  std::uint64_t out_of_range = 0;
  std::map<int, std::string> cameras, tables;  ///< lines of the BOP lists

  fs::path image_file(const char* folder, int image) const {
    return scene / folder / fmt::format("{:06}.png", image);
  }

  void write_image(const char* folder, int image, const cv::Mat& pixels) {
    const std::vector<std::byte> png = encode_png(pixels, options.png_compression);
    try {
      write_file_bytes(image_file(folder, image), png);
    } catch (const InputError& error) {
      throw DeviceError("", error.what(), "make space on the disk");
    }
    bytes += png.size();
  }

  void forget(int image) const {
    std::error_code ignored;
    for (const char* folder : {"rgb", "depth"}) fs::remove(image_file(folder, image), ignored);
  }

  void remember(int image, const RgbdFrame& frame) {
    const CameraModel& c = frame.camera;
    Json camera = {{"cam_K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
                   {"depth_scale", options.depth_scale_mm}};
    if (c.has_distortion()) camera["distortion"] = c.distortion;
    cameras[image] = camera.dump();
    if (!frame.table) return;
    tables[image] = Json{{"pitch_rad", frame.table->pitch_rad()},
                         {"roll_rad", frame.table->roll_rad()},
                         {"height_m", frame.table->camera_height_m}}
                        .dump();
  }
};

RecordingWriter::RecordingWriter(const RecordingOptions& options) : impl_(std::make_unique<Impl>()) {
  if (!(options.depth_scale_mm >= 1e-3 && options.depth_scale_mm <= 100)) {
    throw UsageError("the depth scale must lie between 0.001 and 100 mm");
  }
  if (options.png_compression < 0 || options.png_compression > 9) {
    throw UsageError("the PNG compression must be 0..9");
  }
  impl_->options = options;
  const fs::path split_folder = options.folder / options.split;
  make_folder(split_folder);
  impl_->scene = split_folder / fmt::format("{:06}", next_scene(split_folder));
  make_folder(impl_->scene / "rgb");
  make_folder(impl_->scene / "depth");
  impl_->list.emplace(impl_->scene / kRecordingList);
  impl_->list->append(recording_header());
}

RecordingWriter::~RecordingWriter() = default;

void RecordingWriter::write(const RgbdFrame& frame) {
  if (frame.colour.type() != CV_8UC3 || frame.axial_depth_m.type() != CV_32FC1 ||
      frame.colour.size() != frame.axial_depth_m.size() || frame.colour.empty()) {
    throw InputError("frame " + std::to_string(frame.sequence), "has no matching colour and depth images");
  }
  const int image = impl_->next_image;
  try {
    impl_->write_image("rgb", image, frame.colour);
    impl_->write_image("depth", image,
                       raw_depth(frame.axial_depth_m, impl_->options.depth_scale_mm, impl_->out_of_range));
    RecordedFrame recorded{image, impl_->options.depth_scale_mm, frame};
    impl_->list->append(line_of(recorded));
  } catch (...) {
    impl_->forget(image);
    throw;
  }
  impl_->remember(image, frame);
  ++impl_->next_image;
}

void RecordingWriter::finish(const RecordingEnd& end) {
  impl_->list->append(line_of(end));
  try {
    write_list(impl_->scene / "scene_camera.json", impl_->cameras);
    if (!impl_->tables.empty()) write_list(impl_->scene / "scene_table.json", impl_->tables);
  } catch (const InputError& error) {
    throw DeviceError("", error.what(),
                      fmt::format("the recording itself is whole: {} has all of it", kRecordingList));
  }
}

const fs::path& RecordingWriter::scene_folder() const { return impl_->scene; }
std::uint64_t RecordingWriter::bytes_written() const { return impl_->bytes + impl_->list->size(); }
std::uint64_t RecordingWriter::depth_out_of_range() const { return impl_->out_of_range; }

}  // namespace sextant
