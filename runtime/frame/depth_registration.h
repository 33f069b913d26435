// SPDX-License-Identifier: Apache-2.0
// Depth from the depth camera's view into the colour camera's, with given extrinsics. Every depth pixel is
// moved with its footprint, the nearest surface wins (z-buffer), and what the depth camera did not see stays
// missing: nothing is interpolated across a hole or an edge.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"

namespace sextant {

/// Registers the images of one pair of cameras. Holds the rays of the depth camera and reused rows: one
/// thread at a time.
class DepthRegistration {
 public:
  /// depth, colour: calibrations of the two images, lens distortion and fx != fy allowed in both; the image
  /// that comes out has the size and calibration of `colour` (give it an ideal camera to rectify in the same
  /// step, a smaller one to resample). colour_from_depth: rigid, metres. Throws InputError(where) for a
  /// calibration that is none and a transform that is not rigid or longer than 2 m.
  DepthRegistration(const CameraModel& depth, const CameraModel& colour,
                    const RigidTransform& colour_from_depth, const std::string& where);

  /// axial_depth_m: CV_32FC1 of the depth camera, metres along its axis; 0, negative and non-finite =
  /// missing. Result: CV_32FC1 metres along the colour camera's axis, 0 = missing. A pixel takes the sample
  /// whose footprint covers its centre; footprints of neighbours on one surface touch (no cracks), and end
  /// half a pixel beyond a sample where the surface ends. Of a depth image that is finer by a whole number,
  /// one sample stands for so many pixels a side. Throws InputError for another type or size.
  cv::Mat registered(const cv::Mat& axial_depth_m);

 private:
  /// One row of depth samples seen from the colour camera, with one missing sample before and one after it,
  /// so that neighbours need no special case.
  struct Row {
    std::vector<float> u, v, z;  ///< pixel and axial depth there; z 0 = missing
  };

  int rows() const { return depth_.height / stride_; }
  /// Column or row of the depth image behind that of a sample.
  int pixel_of(int sample) const { return sample * stride_ + (stride_ - 1) / 2; }
  void project(const cv::Mat& depth, int y, Row& row) const;
  void splat(const Row& above, const Row& row, const Row& below, cv::Mat& out);

  CameraModel depth_;
  CameraModel colour_;
  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
  bool colour_distorted_ = false;
  float farthest_tangent2_ = 0;  ///< of the colour image, squared, with a margin
  int stride_ = 1;               ///< depth pixels from one sample to the next
  int columns_ = 0;              ///< samples in a row
  float half_x_ = 0;             ///< half a sample at equal depth, colour pixels
  float half_y_ = 0;
  std::vector<float> rays_[3];  ///< rotated tangent rays of every sample, by coordinate
  Row row_buffers_[3];
  std::vector<int> left_, right_, top_, bottom_;  ///< first and last pixels of one row's footprints
};

}  // namespace sextant
