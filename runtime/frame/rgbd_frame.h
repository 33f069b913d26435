// SPDX-License-Identifier: Apache-2.0
// A frame as a source delivers it: colour, depth registered to the colour camera, calibration, time.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "runtime/frame/capture_time.h"
#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {

/// One RGB-D frame. Colour and depth share size and calibration.
struct RgbdFrame {
  cv::Mat colour;         ///< CV_8UC3, RGB order
  cv::Mat axial_depth_m;  ///< CV_32FC1, metres along the optical axis; 0 = missing
  CameraModel camera;
  std::optional<TableGeometry> table;                 ///< camera over table, where the source knows it
  std::optional<TableUncertainty> table_uncertainty;  ///< of `table`; empty: taken as exact
  CaptureTime captured_at{};                          ///< on the wall clock, for messages
  MonotonicTime captured_monotonic{};                 ///< the same instant, for ages
  std::int64_t sequence = 0;
  std::int64_t scene_id = 0;  ///< BOP scene and image number for data sets, else 0
  std::int64_t image_id = 0;
  std::string frame_id;  ///< name of the camera's optical frame, e.g. "camera_color_optical_frame"
};

}  // namespace sextant
