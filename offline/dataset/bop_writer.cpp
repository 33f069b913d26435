// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/bop_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "offline/dataset/ply_writer.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kPngLevel = 2;  ///< noise hardly shrinks any further

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "this folder cannot be made (" + error.message() + ")");
}

Json box(const cv::Rect& r) { return r.empty() ? Json{-1, -1, -1, -1} : Json{r.x, r.y, r.width, r.height}; }

Json truth_of(const BopInstance& instance) {
  const Eigen::Matrix3d r = instance.camera_from_mesh.linear();
  const Eigen::Vector3d t = instance.camera_from_mesh.translation() * 1000.0;
  return {{"cam_R_m2c", {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}},
          {"cam_t_m2c", {t.x(), t.y(), t.z()}},
          {"obj_id", instance.object_id}};
}

Json info_of(const BopInstance& instance) {
  const double fraction =
      instance.pixels_all > 0 ? static_cast<double>(instance.pixels_visible) / instance.pixels_all : 0;
  return {{"bbox_obj", box(instance.bbox_object)},     {"bbox_visib", box(instance.bbox_visible)},
          {"px_count_all", instance.pixels_all},       {"px_count_valid", instance.pixels_valid},
          {"px_count_visib", instance.pixels_visible}, {"visib_fract", fraction}};
}

cv::Mat raw_depth(const cv::Mat& metres, double scale_mm) {
  cv::Mat raw(metres.size(), CV_16UC1, cv::Scalar(0));
  for (int y = 0; y < metres.rows; ++y) {
    for (int x = 0; x < metres.cols; ++x) {
      const double value = std::round(metres.at<float>(y, x) * 1000.0 / scale_mm);
      if (value >= 1 && value <= 65535) raw.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(value);
    }
  }
  return raw;
}

/// The four lists of one scene, by image number.
struct Scene {
  std::map<int, Json> camera, truth, info, table;
};

void write_list(const fs::path& file, const std::map<int, Json>& list) {
  // One image per line: readable, and small diffs.
  std::string text = "{";
  for (const auto& [image, entry] : list) {
    text += fmt::format("{}\n \"{}\": {}", text.size() > 1 ? "," : "", image, entry.dump());
  }
  text += "\n}\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

}  // namespace

struct BopWriter::Impl {
  fs::path folder;
  std::string split;
  double depth_scale_mm = 0.1;
  ModelsInfo models;
  std::map<int, Scene> scenes;

  fs::path scene_folder(int scene) const { return folder / split / fmt::format("{:06}", scene); }
};

BopWriter::BopWriter(fs::path folder, std::string split, double depth_scale_mm)
    : impl_(std::make_unique<Impl>()) {
  impl_->folder = std::move(folder);
  impl_->split = std::move(split);
  impl_->depth_scale_mm = depth_scale_mm;
  make_folder(impl_->folder / impl_->split);
}

BopWriter::~BopWriter() = default;

void BopWriter::add_model(int object_id, const StandingObject& object) {
  make_folder(impl_->folder / "models");
  write_ply_mm(impl_->folder / "models" / fmt::format("obj_{:06}.ply", object_id), object.mesh,
               object.object_from_mesh.inverse());
  impl_->models[object_id] = measure_model(object);
}

void BopWriter::add_image(int scene_id, int image_id, const RgbdFrame& frame,
                          const std::vector<BopInstance>& instances) {
  write_pictures(scene_id, image_id, frame);
  add_entries(scene_id, image_id, frame, instances);
}

void BopWriter::write_pictures(int scene_id, int image_id, const RgbdFrame& frame) const {
  const fs::path folder = impl_->scene_folder(scene_id);
  if (frame.camera.has_distortion()) {
    throw InputError(folder.string(), "a BOP data set cannot hold a camera with lens distortion",
                     "rectify the frames");
  }
  make_folder(folder / "rgb");
  make_folder(folder / "depth");
  const std::string name = fmt::format("{:06}.png", image_id);
  write_png(folder / "rgb" / name, frame.colour, kPngLevel);
  write_png(folder / "depth" / name, raw_depth(frame.axial_depth_m, impl_->depth_scale_mm), kPngLevel);
}

void BopWriter::add_entries(int scene_id, int image_id, const RgbdFrame& frame,
                            const std::vector<BopInstance>& instances) {
  Scene& scene = impl_->scenes[scene_id];
  const CameraModel& c = frame.camera;
  scene.camera[image_id] = {{"cam_K", {c.fx, 0.0, c.cx, 0.0, c.fy, c.cy, 0.0, 0.0, 1.0}},
                            {"depth_scale", impl_->depth_scale_mm}};
  if (frame.table) {
    scene.table[image_id] = {{"pitch_rad", frame.table->pitch_rad()},
                             {"roll_rad", frame.table->roll_rad()},
                             {"height_m", frame.table->camera_height_m}};
  }
  Json truth = Json::array();
  Json info = Json::array();
  for (const BopInstance& instance : instances) {
    truth.push_back(truth_of(instance));
    info.push_back(info_of(instance));
  }
  scene.truth[image_id] = truth;
  scene.info[image_id] = info;
}

void BopWriter::finish() {
  for (const auto& [id, scene] : impl_->scenes) {
    const fs::path folder = impl_->scene_folder(id);
    write_list(folder / "scene_camera.json", scene.camera);
    write_list(folder / "scene_gt.json", scene.truth);
    write_list(folder / "scene_gt_info.json", scene.info);
    if (!scene.table.empty()) write_list(folder / "scene_table.json", scene.table);
  }
  if (!impl_->models.empty()) write_models_info(impl_->folder / "models" / "models_info.json", impl_->models);
}

}  // namespace sextant
