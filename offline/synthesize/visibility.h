// SPDX-License-Identifier: Apache-2.0
// How much of an object a picture shows, and what hides the rest.
#pragma once

#include "offline/render/renderer.h"

namespace sextant {

/// Counts of pixels of one object's silhouette.
struct Visibility {
  int all = 0;           ///< of the whole silhouette, inside the picture or not
  int inside = 0;        ///< inside the picture
  int visible = 0;       ///< of them not hidden by something nearer
  cv::Rect box_all;      ///< may reach outside of the picture
  cv::Rect box_visible;  ///< empty where nothing is seen
  int worst_hider = -1;  ///< item that hides most of it, -1: none
  double occlusion() const { return inside > 0 ? 1 - static_cast<double>(visible) / inside : 1; }
};

/// `scene`: geometry of all items over the whole picture; `index`: of the object among them.
/// bounding_radius_m: of the object about its mesh frame's origin.
Visibility measure_visibility(Renderer& renderer, const PinholeCamera& camera,
                              const std::vector<RenderItem>& items, std::size_t index,
                              double bounding_radius_m, const RenderedView& scene);

}  // namespace sextant
