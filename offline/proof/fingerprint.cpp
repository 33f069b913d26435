// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/fingerprint.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include "runtime/base/error.h"

namespace sextant {
namespace {

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), XXH3_freeState) { XXH3_64bits_reset(state_.get()); }
  void add(const void* data, std::size_t bytes) { XXH3_64bits_update(state_.get(), data, bytes); }
  template <typename Number>
  void add_number(Number value) {
    add(&value, sizeof value);
  }
  void add_image(const cv::Mat& image) {
    for (const int number : {image.rows, image.cols, image.type()}) add_number(number);
    for (int y = 0; y < image.rows; ++y) {
      add(image.ptr(y), static_cast<std::size_t>(image.cols) * image.elemSize());
    }
  }
  std::string text() const { return fmt::format("{:016x}", XXH3_64bits_digest(state_.get())); }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

}  // namespace

std::string frame_fingerprint(const RgbdFrame& frame) {
  Hasher h;
  h.add_image(frame.colour);
  h.add_image(frame.axial_depth_m);
  const CameraModel& c = frame.camera;
  h.add_number(c.width);
  h.add_number(c.height);
  for (const double d : {c.fx, c.fy, c.cx, c.cy}) h.add_number(d);
  for (const double d : c.distortion) h.add_number(d);
  h.add_number(static_cast<int>(frame.table.has_value()));
  if (frame.table) {
    for (int i = 0; i < 3; ++i) h.add_number(frame.table->up_in_camera[i]);
    h.add_number(frame.table->camera_height_m);
  }
  h.add_number(static_cast<int>(frame.table_uncertainty.has_value()));
  if (frame.table_uncertainty) {
    const TableUncertainty& u = *frame.table_uncertainty;
    for (const double d : {u.height_m, u.pitch_rad, u.roll_rad, u.tilt_rad, u.surface_m}) h.add_number(d);
  }
  return h.text();
}

std::string file_fingerprint(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), std::strerror(errno), "give the file that the proof names");
  Hasher h;
  std::array<char, 65536> block{};
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    h.add(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) throw InputError(file.string(), "cannot be read");
  return h.text();
}

std::string text_fingerprint(const std::string& text) {
  Hasher h;
  h.add(text.data(), text.size());
  return h.text();
}

}  // namespace sextant
