// SPDX-License-Identifier: Apache-2.0
// Cast shadows on top of the renderer's Lambert light: a second view from the light tells what it does not
// reach.
#pragma once

#include <vector>

#include "offline/render/renderer.h"

namespace sextant {

/// A view with soft shadows of the point light. `focus_in_camera`: the middle of what matters; shadows reach
/// `radius_m` around it. softness_px: half width of the penumbra in pixels of the 1024-pixel shadow map.
RenderedView render_with_shadows(Renderer& renderer, const PinholeCamera& camera,
                                 const std::vector<RenderItem>& items, const Light& light,
                                 const Eigen::Vector3d& background, const Eigen::Vector3d& focus_in_camera,
                                 double radius_m, int softness_px);

}  // namespace sextant
