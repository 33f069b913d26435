// SPDX-License-Identifier: Apache-2.0
// One frame from two image files and a camera file, for `sextant detect --color --depth --camera`.
#pragma once

#include <filesystem>

#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// What a camera file says. YAML keys: width, height, fx, fy, cx, cy (pixels), depth_scale_mm (depth value *
/// scale = mm along the optical axis); optional distortion: [k1, k2, p1, p2, k3, k4, k5, k6] (0 to 8 of them)
/// and pitch_deg (looking down positive), height_m (above the table), roll_deg.
struct CameraFile {
  CameraModel camera;
  double depth_scale_mm = 1;
  std::optional<TableGeometry> table;
};

/// Throws InputError naming file, line and key for anything missing, unknown (with the nearest known key) or
/// out of range.
CameraFile read_camera_file(const std::filesystem::path& file);

/// Throws InputError where a file is missing or damaged or the sizes differ from each other or the camera's.
RgbdFrame load_single_frame(const std::filesystem::path& colour, const std::filesystem::path& depth,
                            const std::filesystem::path& camera_yaml);

}  // namespace sextant
