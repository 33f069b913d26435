// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/bin_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>
#include <set>

#include "runtime/base/error.h"
#include "runtime/geometry/table_geometry.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

LearnParameters narrow() {
  LearnParameters p;
  p.min_pitch_deg = 38;
  p.max_pitch_deg = 44;
  return p;
}

bool holds(const RotationBox& b, double rx, double ry) {
  return b.lo_deg[0] <= rx && rx < b.hi_deg[0] && b.lo_deg[1] <= ry && ry < b.hi_deg[1];
}

// Everything feasible for the declared cameras is covered, and every bin is there for a reason.
TEST(BinLayout, CoversWhatTheCamerasCanSeeAndNoMore) {
  const LearnParameters p = narrow();
  const auto boxes = lay_out_bins(p, 0);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  std::set<std::size_t> used;
  for (int i = 0; i < 300000; ++i) {
    // Half of the time at an end of the range: corners of the space decide which bins exist.
    const auto within = [&](double lo, double hi) {
      const double u = unit(random);
      return u < 0.25 ? lo : (u < 0.5 ? hi : lo + (hi - lo) * unit(random));
    };
    const auto table = TableGeometry::from_pitch_roll(within(38, 44) * kDegree,
                                                      within(-p.max_roll_deg, p.max_roll_deg) * kDegree, 1);
    const UprightPose up = upright_pose_at(p.camera, table.up_in_camera, within(0, 639), within(0, 479));
    if (up.sine_of_elevation <= 0) continue;
    const double rx = up.rx / kDegree + within(-12, 12);
    const double ry = std::max(-90.0, up.ry / kDegree + within(-12, 12));
    const auto found =
        std::find_if(boxes.begin(), boxes.end(), [&](const RotationBox& b) { return holds(b, rx, ry); });
    ASSERT_NE(found, boxes.end()) << rx << " " << ry;
    used.insert(static_cast<std::size_t>(found - boxes.begin()));
  }
  // A bin that no sample hits may only be grazed by the slack at the very edge.
  EXPECT_GE(used.size() + 2, boxes.size());
}

TEST(BinLayout, SymmetryShortensTheTurntable) {
  const std::size_t cells = lay_out_bins(narrow(), 0).size();
  EXPECT_EQ(lay_out_bins(narrow(), 90).size(), cells * 5);
  EXPECT_EQ(lay_out_bins(narrow(), 180).size(), cells * 9);
  const auto full = lay_out_bins(narrow(), 360);
  EXPECT_EQ(full.size(), cells * 18);
  for (const RotationBox& b : full) {
    EXPECT_EQ(b.hi_deg[2] - b.lo_deg[2], 20);
    EXPECT_EQ(b.hi_deg[0] - b.lo_deg[0], 20);
  }
  EXPECT_THROW(lay_out_bins(narrow(), 45), UsageError);
}

TEST(BinLayout, AllOrientationsAreAll) {
  for (const int width : {20, 16, 45}) {
    LearnParameters p = narrow();
    p.all_orientations = 1;
    p.bin_width_deg = width;
    const auto boxes = lay_out_bins(p, 0);
    for (int rx = -180; rx < 180; ++rx) {
      for (int ry = -90; ry <= 90; ++ry) {
        const auto count =
            std::count_if(boxes.begin(), boxes.end(), [&](const RotationBox& b) { return holds(b, rx, ry); });
        ASSERT_EQ(count, 1) << width << " deg: " << rx << " " << ry;
      }
    }
    for (const RotationBox& b : boxes) {
      EXPECT_GE(b.lo_deg[0], -180);
      EXPECT_LE(b.hi_deg[0], 180);
      EXPECT_LE(b.hi_deg[1], 91);
    }
  }
  LearnParameters p = narrow();
  p.all_orientations = 1;
  EXPECT_EQ(lay_out_bins(p, 360).size(), 19U * 9 * 18);
}

TEST(BinLayout, OneBinIsCentredOnUpright) {
  const auto boxes = lay_out_bins(narrow(), 0);
  EXPECT_TRUE(
      std::any_of(boxes.begin(), boxes.end(), [](const RotationBox& b) { return b.lo_deg[0] == -10; }));
}

TEST(BinLayout, BinsDoNotOverlap) {
  const auto boxes = lay_out_bins(narrow(), 180);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      bool apart = false;
      for (std::size_t a = 0; a < 3; ++a) {
        apart = apart || boxes[i].hi_deg[a] <= boxes[k].lo_deg[a] || boxes[k].hi_deg[a] <= boxes[i].lo_deg[a];
      }
      ASSERT_TRUE(apart);
    }
  }
}

}  // namespace
}  // namespace sextant
