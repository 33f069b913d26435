// SPDX-License-Identifier: Apache-2.0
// Headless rendering: EGL surfaceless (software Mesa, or a GPU where there is one), colour and exact ray
// depth. The depth is computed per pixel from the interpolated surface point, never read from a z-buffer.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "offline/mesh/mesh.h"
#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// One thing to draw.
struct RenderItem {
  int mesh = 0;  ///< handle from Renderer::upload
  RigidTransform camera_from_mesh = RigidTransform::Identity();
  double gloss = 0;  ///< 0..1: strength of the highlight that a light makes on it
};

/// A weaker light beside the main one.
struct FillLight {
  Eigen::Vector3d position_in_camera{0, 0, 0};  ///< metres
  double strength = 0;                          ///< of a surface that faces it, 0..1
};

inline constexpr std::size_t kMaxFillLights = 3;

/// Lambert light from one point plus ambient, and up to kMaxFillLights others.
struct Light {
  Eigen::Vector3d position_in_camera{0, 0, 0};  ///< metres
  double ambient = 0.4;                         ///< 0..1: share of the light that comes from everywhere
  double strength = 1;                          ///< of the point light's share; 0: switched off
  std::vector<FillLight> fills{};               ///< added to it; those beyond the limit are ignored
};

/// What came out.
struct RenderedView {
  cv::Mat colour;       ///< CV_8UC3 RGB, anti-aliased
  cv::Mat ray_depth_m;  ///< CV_32FC1, distance from the focal point, metres; 0 = background
  cv::Mat item;         ///< CV_16SC1, index of the item seen at each pixel, -1 = background
};

/// An EGL context and its meshes. One thread at a time; make one Renderer per thread.
class Renderer {
 public:
  Renderer();  ///< Throws DeviceError where there is no EGL.
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Copies a mesh to the renderer and returns its handle.
  int upload(const Mesh& mesh);
  /// Forgets a mesh.
  void release(int mesh);
  /// Draws all items. `window` selects pixels of the camera's image (may reach outside of it): the result
  /// has the window's size. background: RGB 0..255.
  RenderedView render(const PinholeCamera& camera, const cv::Rect& window,
                      const std::vector<RenderItem>& items, const Light& light,
                      const Eigen::Vector3d& background);
  /// The colour pass of render() alone.
  cv::Mat render_colour(const PinholeCamera& camera, const cv::Rect& window,
                        const std::vector<RenderItem>& items, const Light& light,
                        const Eigen::Vector3d& background);
  /// Depth and items alone (colour stays empty): a fraction of the time.
  RenderedView render_geometry(const PinholeCamera& camera, const cv::Rect& window,
                               const std::vector<RenderItem>& items);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sextant
