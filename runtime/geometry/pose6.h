// SPDX-License-Identifier: Apache-2.0
// The pose tuple of the thesis (Davies 2015, sec. 3.1): what the model is learned in and the search walks.
#pragma once

namespace sextant {

/// Pose of an object's centre frame as the search sees it. The centre is the centre of the mesh's bounding
/// sphere, the frame is z up when the object stands in the resting pose of its model.
struct Pose6 {
  double x =
      0;  ///< column of the projected centre, pixels of the rectified image (pixel centres are integers)
  double y = 0;   ///< row of the projected centre, pixels
  double z = 0;   ///< distance from the focal point to the centre along the ray, metres
  double rx = 0;  ///< rotation about the line of sight (clockwise in the image), radians
  double ry = 0;  ///< minus the elevation from which the object is seen: 0 level, -pi/2 from straight above
  double rz = 0;  ///< turntable angle about the object's vertical, radians
};

}  // namespace sextant
