// SPDX-License-Identifier: Apache-2.0
// A data set in the scenewise layout of the BOP challenge (bop.felk.cvut.cz, "BOP datasets format"), with our
// scene_table.json beside it. Playback, `sextant detect` and evaluation all read it through here.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/frame/rgbd_frame.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// Ground truth of one object in one image.
struct BopGt {
  int object_id = 0;
  RigidTransform camera_from_mesh = RigidTransform::Identity();  ///< mesh's own frame, metres
  std::optional<double> visible_fraction;                        ///< scene_gt_info.json, 0..1
  std::optional<cv::Rect2d> bbox;  ///< scene_gt_info.json, of the whole silhouette (bbox_obj), pixels
};

/// One image of a data set: where its files are and what is known of it. Nothing of the pixels is read yet.
struct BopImage {
  int scene_id = 0;
  int image_id = 0;
  std::filesystem::path colour;  ///< rgb/ or gray/, .png or .jpg; the first guess where none exists
  std::filesystem::path depth;   ///< depth/, .png
  /// width and height are 0: load_frame takes them from the image. Lens distortion comes from our own key
  /// "distortion" (8 numbers, OpenCV's order), which `sextant record` writes beside cam_K where there is
  /// some.
  CameraModel camera;
  double depth_scale_mm = 1;           ///< depth value * scale = mm along the optical axis
  std::optional<TableGeometry> table;  ///< scene_table.json
  std::vector<BopGt> ground_truth;     ///< in the order of scene_gt.json; empty without one
};

/// A data set, or the one scene of it that was asked for.
struct BopDataset {
  std::filesystem::path folder;
  std::string split;
  bool has_ground_truth = false;  ///< at least one scene has a scene_gt.json
  std::vector<BopImage> images;   ///< by scene, then image number
};

/// Scene numbers and folders of a split, ascending (wanted >= 0: that scene only). Throws InputError where
/// the folder cannot be opened and where there is none.
std::vector<std::pair<int, std::filesystem::path>> list_scenes(const std::filesystem::path& split_folder,
                                                               int wanted);

/// Reads the lists of every scene of folder/split (scene >= 0: of that scene only). Throws InputError naming
/// file, image and key where a list is missing, damaged or contradictory, and where there is no image at all.
BopDataset open_bop_dataset(const std::filesystem::path& folder, const std::string& split, int scene = -1);

/// Reads colour and depth of an image. captured_at, sequence and frame_id stay empty.
/// Throws InputError for files that are missing or damaged, or whose sizes differ.
RgbdFrame load_frame(const BopImage& image);

}  // namespace sextant
