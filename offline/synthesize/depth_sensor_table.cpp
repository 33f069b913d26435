// SPDX-License-Identifier: Apache-2.0
// The measured cameras. Fast noise and slow warp per depth: medians over the frames; correlations of the fast
// part at 1 / 4 pixels: Kinect v1 0.73 / 0.40, Xtion 0.92 / 0.67, RealSense 0.95 / 0.80; shadow baselines:
// run length of missing pixels beside silhouettes / (focal length * step of inverse depth), left / right:
// Kinect v1 0.037-0.075 / 0.017 m, Xtion 0.048 / 0.048, RealSense 0.076 / 0.005. The shares solve for
// variance and correlations of Gaussian fields after a mean over 31 pixels is taken off.
#include "offline/synthesize/depth_sensor.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

DepthSensor kinect1() {
  DepthSensor s;
  s.name = "kinect1";
  s.fast_noise.rows = {{0.55, 0.76}, {0.65, 1.08}, {0.75, 1.24}, {0.85, 1.53}, {0.95, 1.86}, {1.05, 2.21},
                       {1.15, 2.67}, {1.25, 3.16}, {1.35, 3.55}, {1.45, 3.99}, {1.55, 4.56}};
  s.slow_warp.rows = {{0.65, 1.5}, {0.75, 1.4}, {0.85, 1.4}, {0.95, 1.6}, {1.05, 1.7},
                      {1.15, 1.6}, {1.25, 1.6}, {1.35, 2.3}, {1.45, 2.7}, {1.55, 3.5}};
  s.white_share = 0.07;
  s.fine_share = 0.29;
  s.fine_sigma_px = 1.0;
  s.coarse_share = 0.86;
  s.coarse_sigma_px = 5;
  s.coarse_in_slow = 0.19;
  s.quantisation_per_m = 2.85e-3;  // 1/8 pixel of disparity at f = 580, baseline 75 mm
  s.round_mm = 1;
  s.shadow_left_m = 0.055;
  s.shadow_right_m = 0.015;
  s.edge_jitter_px = 0.8;
  s.edge_loss_px = 0.8;
  s.hole_share = 0.0005;
  s.object_hole_lo = 0;
  s.object_hole_hi = 0.04;
  s.nearest_m = 0.45;
  s.farthest_m = 4.0;
  s.misregistration_px = 0.7;
  return s;
}

DepthSensor xtion() {
  DepthSensor s;
  s.name = "xtion";
  s.focal_px = 1067;
  s.fast_noise.rows = {{0.55, 1.0}, {0.65, 1.2},  {0.75, 1.4}, {0.85, 1.55},
                       {0.95, 2.1}, {1.05, 2.55}, {1.15, 3.5}, {1.25, 5.4}};
  s.slow_warp.rows = {{0.65, 1.3}, {0.75, 1.4}, {0.85, 1.5}, {0.95, 1.9}, {1.05, 2.3}, {1.15, 2.6}};
  s.white_share = 0.05;
  s.fine_share = 0.14;
  s.fine_sigma_px = 1.3;
  s.coarse_share = 1.73;
  s.coarse_sigma_px = 6;
  s.coarse_in_slow = 0.50;
  s.warp_sigma_px = 80;
  s.round_mm = 1;
  s.shadow_left_m = 0.035;
  s.shadow_right_m = 0.035;
  s.edge_jitter_px = 1.5;
  s.edge_loss_px = 4;
  s.hole_share = 0.01;
  s.object_hole_lo = 0.05;
  s.object_hole_hi = 0.23;
  s.nearest_m = 0.4;
  s.farthest_m = 4.0;
  s.misregistration_px = 2.0;
  return s;
}

DepthSensor realsense() {
  DepthSensor s;
  s.name = "realsense";
  s.focal_px = 615;
  s.fast_noise.rows = {{0.35, 0.37}, {0.45, 0.5}, {0.55, 0.75}, {0.65, 0.95}, {0.75, 1.4}, {0.85, 1.75},
                       {0.95, 2.15}, {1.05, 2.6}, {1.15, 2.9},  {1.25, 3.8},  {1.35, 5.4}};
  s.slow_warp.rows = {{0.35, 0.3}, {0.45, 0.6}, {0.55, 1.2}, {0.65, 1.6},
                      {0.75, 1.9}, {0.95, 2.2}, {1.25, 2.5}};
  s.white_share = 0.03;
  s.fine_share = 0.06;
  s.fine_sigma_px = 1.3;
  s.coarse_share = 3.38;
  s.coarse_sigma_px = 8;
  s.coarse_in_slow = 1.42;
  s.round_mm = 0.1;
  s.shadow_left_m = 0.07;
  s.shadow_right_m = 0.005;
  s.edge_jitter_px = 1.0;
  s.edge_loss_px = 0.5;
  s.hole_share = 0.003;
  s.object_hole_lo = 0.02;
  s.object_hole_hi = 0.04;
  s.nearest_m = 0.2;
  s.farthest_m = 6.0;
  s.misregistration_px = 0.7;
  return s;
}

}  // namespace

DepthSensor depth_sensor(const std::string& name) {
  if (name == "kinect1") return kinect1();
  if (name == "xtion") return xtion();
  if (name == "realsense") return realsense();
  if (name == "none") {
    DepthSensor perfect;
    perfect.name = name;
    return perfect;
  }
  throw UsageError("there is no sensor \"" + name + "\"", "choose kinect1, xtion, realsense or none");
}

}  // namespace sextant
