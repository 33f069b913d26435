// SPDX-License-Identifier: Apache-2.0
// A rendered view as a frame from a perfect camera.
#pragma once

#include "offline/render/renderer.h"
#include "runtime/frame/rgbd_frame.h"

namespace sextant {

inline RgbdFrame frame_of(const RenderedView& view, const PinholeCamera& camera, const TableGeometry& table) {
  RgbdFrame frame;
  frame.colour = view.colour;
  frame.camera = {camera.width, camera.height, camera.focal, camera.focal, camera.cx, camera.cy, {}};
  frame.table = table;
  frame.axial_depth_m = view.ray_depth_m.clone();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u)
      frame.axial_depth_m.at<float>(v, u) *= static_cast<float>(camera.ray(u, v).z());
  }
  return frame;
}

}  // namespace sextant
