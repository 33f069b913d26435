// SPDX-License-Identifier: Apache-2.0
// What a real depth camera makes of a perfect depth image. The numbers were measured on tables in real frames
// (residuals to the fitted plane, split at 31 pixels into a slow and a fast part); the displaced edges follow
// Handa et al., "A benchmark for RGB-D visual odometry, 3D reconstruction and SLAM", ICRA 2014.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace sextant {

/// A value that grows with depth: linear between the rows; outside of them it scales with the depth squared.
struct DepthTable {
  struct Row {
    double depth_m = 0;
    double value_mm = 0;
  };
  std::vector<Row> rows;
  double at(double depth_m) const;
};

/// A depth camera. All lengths in pixels are at `focal_px`.
struct DepthSensor {
  std::string name;
  double focal_px = 525;  ///< of the images the numbers were measured in
  DepthTable fast_noise;  ///< rms of the fast part, quantisation included
  DepthTable slow_warp;   ///< rms of the slow part
  /// Variances of the noise's components in units of the fast variance. They sum to more than 1 because some
  /// of the coarse one is measured as slow; what is missing at 1 and 4 pixels is the quantisation's.
  double white_share = 0;
  double fine_share = 0;  ///< correlated over fine_sigma_px
  double fine_sigma_px = 1;
  double coarse_share = 0;  ///< correlated over coarse_sigma_px
  double coarse_sigma_px = 5;
  double coarse_in_slow = 0;  ///< share of the fast variance that the coarse component adds to the slow part
  double warp_sigma_px = 60;  ///< correlation length of the slow part
  double quantisation_per_m = 0;  ///< step = this * depth^2 metres (equal steps of disparity); 0: none
  double round_mm = 0;            ///< steps of the file format, mm; 0: none
  double shadow_left_m = 0;       ///< baseline that hides the background left of near silhouettes
  double shadow_right_m = 0;      ///< the same on the right
  double edge_jitter_px = 0;      ///< rms displacement of depth edges
  double edge_loss_px = 0;        ///< about so many pixels around depth edges go missing
  double hole_share = 0;          ///< of all pixels, lost in blobs of a few pixels
  double object_hole_lo = 0;      ///< each object loses a share of its pixels in blobs, drawn from
  double object_hole_hi = 0;      ///< lo..hi (dark, shiny or steep surfaces)
  double nearest_m = 0;           ///< nothing nearer is seen
  double farthest_m = 100;        ///< nothing farther is seen
  double misregistration_px = 0;  ///< rms shift of the depth against the colour image, per axis
};

/// "kinect1", "xtion", "realsense" or "none" (every number 0: the input comes back). Throws UsageError.
DepthSensor depth_sensor(const std::string& name);

/// Which object is seen at each pixel, and those that give no depth.
struct DepthSurfaces {
  cv::Mat object;             ///< CV_16SC1, number of the object, -1: table, floor, walls; empty: no objects
  std::vector<int> no_depth;  ///< objects that reflect the pattern away: nearly all of their depth is missing
};

/// axial_depth_m: CV_32FC1 of a camera with focal length focal_px, 0 = missing. Returns the same kind of
/// image as the sensor would give it. Pure: the same seed gives the same image.
cv::Mat apply_depth_sensor(const cv::Mat& axial_depth_m, double focal_px, const DepthSensor& sensor,
                           std::uint64_t seed, const DepthSurfaces& surfaces = {});

}  // namespace sextant
