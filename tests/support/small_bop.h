// SPDX-License-Identifier: Apache-2.0
// A tiny BOP data set, written by hand so that tests can spoil any part of it.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "hal/image/image_file.h"

namespace sextant {

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// Colour 32x24 whose first pixel is (scene, image, 7); depth 1000 + image everywhere, scale 0.5 mm.
inline void write_small_image(const std::filesystem::path& scene_folder, int scene, int image) {
  cv::Mat colour(24, 32, CV_8UC3, cv::Scalar(scene, image, 7));
  cv::Mat depth(24, 32, CV_16UC1, cv::Scalar(1000 + image));
  depth.at<std::uint16_t>(0, 0) = 0;
  const std::string name = fmt::format("{:06}.png", image);
  std::filesystem::create_directories(scene_folder / "rgb");
  std::filesystem::create_directories(scene_folder / "depth");
  write_png(scene_folder / "rgb" / name, colour);
  write_png(scene_folder / "depth" / name, depth);
}

/// scenes 1 and 10 (in that numeric order; as text "000010" follows too, but "2" would not), images 2 and 11.
inline void write_small_bop(const std::filesystem::path& folder) {
  for (const int scene : {1, 10}) {
    const std::filesystem::path path = folder / "test" / (scene == 1 ? "000001" : "000010");
    std::string camera = "{";
    for (const int image : {2, 11}) {
      write_small_image(path, scene, image);
      camera += fmt::format(R"({}"{}": {{"cam_K": [30, 0, 15.5, 0, 31, 11.5, 0, 0, 1], "depth_scale": 0.5}})",
                            image == 2 ? "" : ", ", image);
    }
    write_text(path / "scene_camera.json", camera + "}");
    write_text(
        path / "scene_gt.json",
        R"({"2": [{"cam_R_m2c": [0, -1, 0, 1, 0, 0, 0, 0, 1], "cam_t_m2c": [10, -20, 900], "obj_id": 4}],
                   "11": []})");
    write_text(path / "scene_gt_info.json", R"({"2": [{"visib_fract": 0.25, "bbox_obj": [3, 4, 5, 6]}]})");
    write_text(path / "scene_table.json", R"({"2": {"pitch_rad": 0.7, "roll_rad": 0.1, "height_m": 0.6}})");
  }
}

}  // namespace sextant
