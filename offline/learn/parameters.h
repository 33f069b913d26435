// SPDX-License-Identifier: Apache-2.0
// What learning can be told (Davies 2015, table 6.3). Pixels are pixels at 1 m of a camera with focal length
// 525 (the thesis's), whatever camera the model will be used with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "runtime/geometry/camera_model.h"

namespace sextant {

/// The focal length that "pixels" of the parameters refer to.
inline constexpr double kReferenceFocal = 525;

struct LearnParameters {
  int images_per_bin = 60;      ///< n: rendered training images, 10..10000
  int visual_parts = 40;        ///< n_V, 0..1000
  int visual_candidates = 100;  ///< edges put to the test, of which visual_parts are kept, 0..1000
  int depth_parts = 75;         ///< on the object and, with learn_table, beside it, 0..1000
  int learn_table = 1;          ///< 1: what is seen of the table beside the object becomes parts too
  int all_orientations =
      0;  ///< 1: bins for every orientation, whatever the cameras; for searches without a table
  int scenes_per_bin = 24;               ///< scenes in which parts are put to the test; 0: none
  double visual_radius_px = 5;           ///< r_V: receptive field, pixels at 1 m
  double depth_radius_m = 0.02;          ///< r_D
  double missing_depth_m = 0.01;         ///< d0: difference assumed where depth is missing, <= r_D
  double visual_max_variance_px2 = 275;  ///< v_Vmax, pixels^2 at 1 m
  double depth_max_variance_m2 = 0.02;   ///< v_Dmax
  int bin_width_deg = 20;                ///< r_w of rx and ry, 5..45
  int turn_width_deg = 20;               ///< r_w of rz, 5..45
  int grid = 64;                         ///< w: enumeration grid over the object's square, 16..512
  int edge_low = 60;                     ///< EdgeOptions::low
  int edge_high = 120;                   ///< EdgeOptions::high
  double ambient = 0.5;                  ///< share of ambient light, 0..1
  double min_distance_m = 0.5;           ///< nearest training distance
  double max_distance_m = 1.4;           ///< farthest
  double min_pitch_deg = 25;             ///< cameras that will be used: looking down by min..max
  double max_pitch_deg = 55;
  double max_roll_deg = 3;                            ///< of those cameras, to either side
  double angle_tolerance_deg = 12;                    ///< r_tol of the searches that will use the model
  PinholeCamera camera{640, 480, 525, 319.5, 239.5};  ///< training camera and field of view to cover
  std::uint64_t seed = 1;

  /// Throws UsageError for a value outside its range.
  void check() const;
  /// One line of YAML flow mapping, for the model's provenance.
  std::string to_yaml() const;
};

/// Sets the field of this name (as in the YAML file). Throws UsageError for an unknown name, a value outside
/// its range, or a fraction where a whole number is wanted.
void set_learn_parameter(LearnParameters& parameters, const std::string& name, double value);

/// Reads a YAML file of any of the fields above (camera: width, height, focal, cx, cy). Unknown keys are
/// errors. Throws InputError.
LearnParameters read_learn_parameters(const std::filesystem::path& file);

}  // namespace sextant
