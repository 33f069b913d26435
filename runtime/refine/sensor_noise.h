// SPDX-License-Identifier: Apache-2.0
// How far measured depth and edges can be trusted: one model for the structured-light and stereo cameras that
// were measured on tables (docs/BENCHMARKS.md, offline/synthesize/depth_sensor_table.cpp). Neighbouring
// pixels share their noise, so a pixel counts for less than one observation; the slow warp and the shift
// between colour and depth are common to all pixels of an object and never average out.
#pragma once

#include <algorithm>
#include <cmath>

namespace sextant {

/// Depth noise at a ray depth of z metres.
struct DepthNoise {
  /// Fast part, rms, metres: 1.1 mm at 0.65 m, 1.9 at 0.95, 4.6 at 1.55 (Kinect v1; the others are near it).
  static double fast_m(double z) { return std::max(0.0006, 0.0020 * z * z); }
  /// Slow warp, rms, metres: 1.6 mm up to 1.2 m, 3 mm at 1.5 m.
  static double warp_m(double z) { return 0.0016 * std::max(1.0, z * z / 1.2); }
  /// Slope of the warp, rms, metres per unit of tangent: a Gaussian field of 60 px (f = 525) correlation.
  static double warp_slope_m(double z) { return warp_m(z) * 525 / (60 * std::sqrt(2.0)); }
  /// Pixels that share one observation of the fast part, at a focal length of f pixels.
  static double pixels_per_observation(double f) { return std::max(1.0, 400 * (f / 525) * (f / 525)); }
  /// Shift of the depth image against the colour image, rms per axis, tangent units (0.8 px at f = 525).
  static constexpr double kShiftTangent = 0.0015;
  /// What a simplified mesh and a real object differ by, metres.
  static constexpr double kSurfaceM = 0.0008;
};

/// Edges: rms of an edge's place across its direction, pixels, and the length of edge (pixels at f = 525)
/// that makes one observation.
struct EdgeNoise {
  static constexpr double kSigmaPx = 1.2;
  static double pixels_per_observation(double f) { return std::max(1.0, 8 * f / 525); }
};

}  // namespace sextant
