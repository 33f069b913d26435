// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/bop_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "hal/image/image_file.h"
#include "hal/playback/depth_image.h"
#include "hal/playback/json_file.h"
#include "hal/playback/rotation_input.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxDistanceMm = 1e6;

std::string image_label(int image) { return "image " + std::to_string(image); }

/// The first of the files that BOP allows for an image.
fs::path find_image(const fs::path& scene, std::initializer_list<const char*> folders, int image) {
  for (const char* folder : folders) {
    for (const char* extension : {".png", ".jpg", ".jpeg"}) {
      fs::path file = scene / folder / fmt::format("{:06}{}", image, extension);
      std::error_code error;
      if (fs::exists(file, error)) return file;
    }
  }
  return scene / *folders.begin() / fmt::format("{:06}.png", image);
}

CameraModel read_camera(const JsonView& entry) {
  const JsonView view = entry.at("cam_K");
  const std::vector<double> k = view.numbers(9);
  CameraModel camera;
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  if (k[1] != 0 || k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
    view.refuse("must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  }
  if (!(camera.fx > 0 && camera.fy > 0)) view.refuse("has a focal length that is not positive");
  if (const auto distortion = entry.find("distortion")) {
    const std::vector<double> d = distortion->numbers(camera.distortion.size());
    std::copy(d.begin(), d.end(), camera.distortion.begin());
  }
  return camera;
}

TableGeometry read_table(const JsonView& entry) {
  constexpr double kPi = std::numbers::pi;
  return TableGeometry::from_pitch_roll(entry.at("pitch_rad").number(-kPi, kPi),
                                        entry.at("roll_rad").number(-kPi, kPi),
                                        entry.at("height_m").number(1e-3, 100));
}

RigidTransform read_pose(const JsonView& entry) {
  const JsonView view = entry.at("cam_R_m2c");
  const std::optional<Eigen::Matrix3d> rotation = rotation_from_rounded(view.numbers(9));
  if (!rotation) view.refuse("is not a rotation matrix");
  const JsonView translation_view = entry.at("cam_t_m2c");
  const std::vector<double> t = translation_view.numbers(3);
  if (std::any_of(t.begin(), t.end(), [](double v) { return std::abs(v) > kMaxDistanceMm; })) {
    translation_view.refuse("is farther than a kilometre; BOP's unit is mm");
  }
  RigidTransform pose = RigidTransform::Identity();
  pose.linear() = *rotation;
  pose.translation() = Eigen::Vector3d(t[0], t[1], t[2]) / 1000.0;
  return pose;
}

void read_info(const JsonView& entry, BopGt& gt) {
  if (const auto view = entry.find("visib_fract")) gt.visible_fraction = view->number(0, 1);
  if (const auto view = entry.find("bbox_obj")) {
    const std::vector<double> b = view->numbers(4);
    // BOP writes [-1, -1, -1, -1] for an object that is not in the image.
    if (b[2] > 0 && b[3] > 0) gt.bbox = cv::Rect2d(b[0], b[1], b[2], b[3]);
  }
}

/// A list that may be absent as a whole.
std::optional<nlohmann::json> read_optional(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  return read_json_file(file);
}

std::vector<BopGt> read_ground_truth(const JsonView& entry, const std::optional<JsonView>& info) {
  std::vector<BopGt> all;
  for (const JsonView& element : entry.elements()) {
    BopGt gt;
    gt.object_id = element.at("obj_id").integer(0, 999'999'999);
    gt.camera_from_mesh = read_pose(element);
    all.push_back(gt);
  }
  if (info) {
    const std::vector<JsonView> infos = info->elements();
    if (infos.size() != all.size()) {
      info->refuse(fmt::format("has {} entries, but scene_gt.json has {}", infos.size(), all.size()));
    }
    for (std::size_t i = 0; i < all.size(); ++i) read_info(infos[i], all[i]);
  }
  return all;
}

void read_scene(int scene, const fs::path& folder, BopDataset& dataset) {
  const fs::path camera_file = folder / "scene_camera.json";
  const nlohmann::json cameras = read_json_file(camera_file);
  const JsonView camera_view(cameras, camera_file.string());

  struct List {
    fs::path file;
    std::optional<nlohmann::json> json;
    explicit List(fs::path path) : file(std::move(path)), json(read_optional(file)) {}
    std::optional<JsonView> entry(int image) const {
      if (!json) return std::nullopt;
      return JsonView(*json, file.string()).find(std::to_string(image), image_label(image));
    }
  };
  const List tables(folder / "scene_table.json");
  const List truth(folder / "scene_gt.json");
  const List info(folder / "scene_gt_info.json");
  dataset.has_ground_truth = dataset.has_ground_truth || truth.json.has_value();

  for (const int number : camera_view.number_keys()) {
    const JsonView entry = camera_view.at(std::to_string(number), image_label(number));
    BopImage image;
    image.scene_id = scene;
    image.image_id = number;
    image.camera = read_camera(entry);
    image.depth_scale_mm = entry.at("depth_scale").number(1e-6, 1e3);
    image.colour = find_image(folder, {"rgb", "gray"}, number);
    image.depth = find_image(folder, {"depth"}, number);
    if (const auto view = tables.entry(number)) image.table = read_table(*view);
    if (const auto view = truth.entry(number))
      image.ground_truth = read_ground_truth(*view, info.entry(number));
    dataset.images.push_back(std::move(image));
  }
}

}  // namespace

std::vector<std::pair<int, fs::path>> list_scenes(const fs::path& split_folder, int wanted) {
  std::error_code error;
  fs::directory_iterator it(split_folder, error);
  if (error) {
    throw InputError(split_folder.string(),
                     "this split of the data set cannot be opened (" + error.message() + ")",
                     "give the folder that holds models/ and test/, and --split");
  }
  std::vector<std::pair<int, fs::path>> scenes;
  for (; it != fs::directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    int number = -1;
    const auto [end, bad] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (bad != std::errc() || end != name.data() + name.size() || number < 0) continue;
    if ((wanted < 0 || wanted == number) && it->is_directory(error)) scenes.emplace_back(number, it->path());
  }
  std::sort(scenes.begin(), scenes.end());
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
  if (const auto twice = std::adjacent_find(scenes.begin(), scenes.end(), same); twice != scenes.end()) {
    throw InputError(split_folder.string(), fmt::format("scene {} is there twice", twice->first));
  }
  if (scenes.empty()) {
    throw InputError(split_folder.string(),
                     wanted < 0 ? std::string("holds no scene") : fmt::format("holds no scene {}", wanted),
                     "scenes are folders with a number, e.g. 000001");
  }
  return scenes;
}

BopDataset open_bop_dataset(const fs::path& folder, const std::string& split, int scene) {
  BopDataset dataset;
  dataset.folder = folder;
  dataset.split = split;
  for (const auto& [number, path] : list_scenes(folder / split, scene)) read_scene(number, path, dataset);
  if (dataset.images.empty())
    throw InputError((folder / split).string(), "holds no image", "check scene_camera.json");
  return dataset;
}

RgbdFrame load_frame(const BopImage& image) {
  RgbdFrame frame;
  frame.colour = read_colour_image(image.colour);
  frame.axial_depth_m = depth_in_metres(read_depth_image(image.depth), image.depth_scale_mm);
  require_same_size(frame.colour, image.colour, frame.axial_depth_m, image.depth);
  frame.camera = image.camera;
  frame.camera.width = frame.colour.cols;
  frame.camera.height = frame.colour.rows;
  const fs::path scene = image.colour.parent_path().parent_path();
  frame.camera.check((scene / "scene_camera.json").string() + ": " + image_label(image.image_id));
  frame.table = image.table;
  frame.scene_id = image.scene_id;
  frame.image_id = image.image_id;
  return frame;
}

}  // namespace sextant
