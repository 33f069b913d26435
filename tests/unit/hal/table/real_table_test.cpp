// SPDX-License-Identifier: Apache-2.0
// The table estimate on real frames of three sensors, against the tables that come with them. The figures of
// docs/BENCHMARKS.md are printed here (--gtest_filter='*Real*').
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "runtime/frame/table_estimate.h"
#include "tests/support/real_data.h"

namespace sextant {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

struct Errors {
  std::vector<double> height_mm, tilt_deg, height_deviations, tilt_deviations;
  int refused = 0;

  static double quantile(std::vector<double> v, double q) {
    if (v.empty()) return 0;
    std::sort(v.begin(), v.end());
    return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
  }
};

Errors measure(const std::filesystem::path& folder) {
  Errors errors;
  for (const BopImage& image : open_bop_dataset(folder, "test").images) {
    if (!image.table) continue;
    const RgbdFrame frame = load_frame(image);
    const auto estimate = estimate_table(table_points(frame));
    const std::string where = fmt::format("scene {} image {}", image.scene_id, image.image_id);
    if (!estimate) {
      ++errors.refused;
      fmt::print("{}: refused: {}\n", where, estimate.error().reason);
      continue;
    }
    const double height = 1e3 * (estimate->table.camera_height_m - image.table->camera_height_m);
    const double tilt = std::atan2(estimate->table.up_in_camera.cross(image.table->up_in_camera).norm(),
                                   estimate->table.up_in_camera.dot(image.table->up_in_camera));
    const TableUncertainty& u = estimate->uncertainty;
    fmt::print(
        "{}: height {:+.1f} mm (deviation {:.1f}), tilt {:.2f} deg ({:.2f}), pitch {:+.2f} roll {:+.2f}, "
        "{:.0f} % inliers\n",
        where, height, 1e3 * u.height_m, tilt * kDegrees, u.tilt_rad * kDegrees,
        (estimate->table.pitch_rad() - image.table->pitch_rad()) * kDegrees,
        (estimate->table.roll_rad() - image.table->roll_rad()) * kDegrees, 100 * estimate->inlier_share);
    errors.height_mm.push_back(std::abs(height));
    errors.tilt_deg.push_back(tilt * kDegrees);
    errors.height_deviations.push_back(std::abs(1e-3 * height) / u.height_m);
    errors.tilt_deviations.push_back(tilt / u.tilt_rad);
  }
  fmt::print(
      "{} frames, {} refused; height median {:.1f} mm, worst {:.1f} mm; tilt median {:.2f} deg, worst {:.2f} "
      "deg; "
      "in claimed deviations: height median {:.1f}, worst {:.1f}, tilt median {:.1f}, worst {:.1f}\n",
      errors.height_mm.size() + static_cast<std::size_t>(errors.refused), errors.refused,
      Errors::quantile(errors.height_mm, 0.5), Errors::quantile(errors.height_mm, 1),
      Errors::quantile(errors.tilt_deg, 0.5), Errors::quantile(errors.tilt_deg, 1),
      Errors::quantile(errors.height_deviations, 0.5), Errors::quantile(errors.height_deviations, 1),
      Errors::quantile(errors.tilt_deviations, 0.5), Errors::quantile(errors.tilt_deviations, 1));
  return errors;
}

void expect_useful(const Errors& errors, int refused = 0) {
  EXPECT_EQ(errors.refused, refused);
  EXPECT_LT(Errors::quantile(errors.height_mm, 1), 13.5);
  // The thesis's tolerances are 13.5 mm and 12 deg: the estimate must leave most of them to the object.
  EXPECT_LT(Errors::quantile(errors.height_mm, 0.5), 5);
  EXPECT_LT(Errors::quantile(errors.tilt_deg, 0.5), 1);
  // The claim must hold, or the search's tolerance is widened by too little.
  for (const auto& deviations : {errors.height_deviations, errors.tilt_deviations}) {
    EXPECT_LT(Errors::quantile(deviations, 0.5), 2);
    EXPECT_LT(Errors::quantile(deviations, 1), 3);
  }
}

TEST(RealTables, Kinect) {
  SEXTANT_NEEDS_REAL_DATA(folder, "mosd_kinect_parametric");
  expect_useful(measure(folder));
}
TEST(RealTables, RealSense) {
  SEXTANT_NEEDS_REAL_DATA(folder, "ycb_rs_6dofgraspnet");
  expect_useful(measure(folder));
}
TEST(RealTables, Xtion) {
  SEXTANT_NEEDS_REAL_DATA(folder, "ycbv_samples");
  // One frame shows a small table above a carpet: doubtful, and said so.
  expect_useful(measure(folder), 1);
}

}  // namespace
}  // namespace sextant
