// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/frame_wire.h"

namespace sextant {
namespace {

void append_image(Bytes& bytes, const cv::Mat& image) {
  append(bytes, image.rows);
  append(bytes, image.cols);
  append(bytes, image.type());
  const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int y = 0; y < image.rows; ++y) {
    const std::size_t at = bytes.size();
    bytes.resize(at + row);
    std::memcpy(bytes.data() + at, image.ptr(y), row);
  }
}

cv::Mat take_image(ByteReader& reader) {
  const auto rows = reader.take<int>();
  const auto columns = reader.take<int>();
  const auto type = reader.take<int>();
  cv::Mat image(rows, columns, type);
  const std::size_t row = static_cast<std::size_t>(columns) * image.elemSize();
  for (int y = 0; y < rows; ++y) std::memcpy(image.ptr(y), reader.take(row), row);
  return image;
}

/// What of a frame is plain numbers.
struct FrameNumbers {
  int width, height;
  std::array<double, 4> focal_and_centre;
  std::array<double, 8> distortion;
  bool has_table, has_uncertainty;
  std::array<double, 4> table;
  TableUncertainty uncertainty;
  std::int64_t scene_id, image_id, sequence;
};

}  // namespace

void append_frame(Bytes& bytes, const RgbdFrame& frame) {
  const CameraModel& c = frame.camera;
  FrameNumbers n{};
  n.width = c.width;
  n.height = c.height;
  n.focal_and_centre = {c.fx, c.fy, c.cx, c.cy};
  n.distortion = c.distortion;
  n.has_table = frame.table.has_value();
  n.has_uncertainty = frame.table_uncertainty.has_value();
  if (frame.table) {
    const Eigen::Vector3d& up = frame.table->up_in_camera;
    n.table = {up.x(), up.y(), up.z(), frame.table->camera_height_m};
  }
  if (frame.table_uncertainty) n.uncertainty = *frame.table_uncertainty;
  n.scene_id = frame.scene_id;
  n.image_id = frame.image_id;
  n.sequence = frame.sequence;
  append(bytes, n);
  append_image(bytes, frame.colour);
  append_image(bytes, frame.axial_depth_m);
}

RgbdFrame take_frame(ByteReader& reader) {
  const auto n = reader.take<FrameNumbers>();
  RgbdFrame frame;
  frame.camera.width = n.width;
  frame.camera.height = n.height;
  frame.camera.fx = n.focal_and_centre[0];
  frame.camera.fy = n.focal_and_centre[1];
  frame.camera.cx = n.focal_and_centre[2];
  frame.camera.cy = n.focal_and_centre[3];
  frame.camera.distortion = n.distortion;
  if (n.has_table) frame.table = TableGeometry{{n.table[0], n.table[1], n.table[2]}, n.table[3]};
  if (n.has_uncertainty) frame.table_uncertainty = n.uncertainty;
  frame.scene_id = n.scene_id;
  frame.image_id = n.image_id;
  frame.sequence = n.sequence;
  frame.colour = take_image(reader);
  frame.axial_depth_m = take_image(reader);
  return frame;
}

}  // namespace sextant
