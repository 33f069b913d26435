// SPDX-License-Identifier: Apache-2.0
// Writes a data set in the scenewise BOP layout that hal/playback reads: models, images, cameras, ground
// truth with visibility, and our scene_table.json.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "offline/dataset/models_info.h"
#include "runtime/frame/rgbd_frame.h"

namespace sextant {

/// One object in one image, with what scene_gt_info.json wants to know.
struct BopInstance {
  int object_id = 0;
  RigidTransform camera_from_mesh = RigidTransform::Identity();  ///< mesh's own frame, metres
  cv::Rect bbox_object;    ///< of the whole silhouette, may reach outside of the image
  cv::Rect bbox_visible;   ///< of what is seen of it
  int pixels_all = 0;      ///< of the whole silhouette, inside the image or not
  int pixels_valid = 0;    ///< of them inside the image with a depth
  int pixels_visible = 0;  ///< of them seen
};

/// Collects lists in memory; images are written at once, the lists by finish() (a data set is whole only
/// then).
class BopWriter {
 public:
  /// Makes the folders. depth_scale_mm: of the 16-bit depth files. Throws InputError where it cannot.
  BopWriter(std::filesystem::path folder, std::string split = "test", double depth_scale_mm = 0.1);
  ~BopWriter();
  BopWriter(const BopWriter&) = delete;
  BopWriter& operator=(const BopWriter&) = delete;

  /// models/obj_<id>.ply in the mesh's own frame, and its line of models_info.json.
  void add_model(int object_id, const StandingObject& object);
  /// rgb/ and depth/ of one image (numbers >= 0, each once) and its list entries. Depth beyond the 16 bits is
  /// written as missing. Throws InputError for a camera with distortion: BOP has no place for it.
  void add_image(int scene_id, int image_id, const RgbdFrame& frame,
                 const std::vector<BopInstance>& instances);
  /// The two halves of add_image: the picture files (safe to call from several threads for different images)
  /// and the list entries.
  void write_pictures(int scene_id, int image_id, const RgbdFrame& frame) const;
  void add_entries(int scene_id, int image_id, const RgbdFrame& frame,
                   const std::vector<BopInstance>& instances);
  /// Writes the lists. Throws InputError where it cannot.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
