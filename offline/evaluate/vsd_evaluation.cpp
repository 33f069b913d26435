// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/vsd_evaluation.h"

#include "offline/evaluate/bop_error.h"
#include "offline/render/renderer.h"

namespace sextant {
namespace {

/// Distances along the rays from depths along the axis.
cv::Mat ray_distance(const cv::Mat& axial_m, const PinholeCamera& camera) {
  cv::Mat result(axial_m.size(), CV_32FC1);
  for (int y = 0; y < axial_m.rows; ++y) {
    for (int x = 0; x < axial_m.cols; ++x)
      result.at<float>(y, x) = static_cast<float>(axial_m.at<float>(y, x) / camera.ray(x, y).z());
  }
  return result;
}

}  // namespace

void add_vsd(EvaluationReport& report, const std::vector<BopImage>& images,
             const std::map<int, EvaluatedObject>& objects, const std::map<int, Mesh>& meshes,
             const std::function<void(std::size_t, std::size_t)>& progress) {
  Renderer renderer;
  std::map<int, int> handles;
  for (const auto& [id, mesh] : meshes) handles[id] = renderer.upload(mesh);
  std::map<std::pair<int, int>, std::vector<InstanceResult*>> by_image;
  for (InstanceResult& r : report.instances) {
    if (r.found && handles.count(r.object_id) > 0) by_image[{r.scene_id, r.image_id}].push_back(&r);
  }
  std::size_t done = 0;
  for (const BopImage& image : images) {
    const auto found = by_image.find({image.scene_id, image.image_id});
    if (found != by_image.end()) {
      const RgbdFrame frame = load_frame(image);
      PinholeCamera camera{frame.camera.width, frame.camera.height, (frame.camera.fx + frame.camera.fy) / 2,
                           frame.camera.cx, frame.camera.cy};
      const cv::Mat measured = ray_distance(frame.axial_depth_m, camera);
      const cv::Rect window(0, 0, camera.width, camera.height);
      for (InstanceResult* r : found->second) {
        const int mesh = handles.at(r->object_id);
        const cv::Mat truth = renderer.render_geometry(camera, window, {{mesh, r->truth}}).ray_depth_m;
        const cv::Mat estimate = renderer.render_geometry(camera, window, {{mesh, r->estimate}}).ray_depth_m;
        r->vsd = vsd(estimate, truth, measured, objects.at(r->object_id).diameter_m);
      }
    }
    if (progress) progress(++done, images.size());
  }
  std::vector<const InstanceResult*> all;
  bool all_known = true;
  for (auto& [id, object] : report.objects) {
    const bool known = handles.count(id) > 0 && objects.at(id).diameter_m > 0;
    std::vector<const InstanceResult*> own;
    for (const InstanceResult& r : report.instances) {
      if (r.object_id == id) own.push_back(&r);
    }
    all.insert(all.end(), own.begin(), own.end());
    all_known = all_known && (known || own.empty());
    if (known && !own.empty()) object.ar_vsd = recall_vsd(own);
  }
  if (all_known && !all.empty()) report.total.ar_vsd = recall_vsd(all);
}

}  // namespace sextant
