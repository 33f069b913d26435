// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/table_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/base/error.h"

namespace sextant {
namespace {

const TableGeometry kFixed = TableGeometry::from_pitch_roll(0.6, 0, 0.7);

TEST(TableConfig, DetectLeavesItToDetection) {
  EXPECT_FALSE(locator_options({}, kFixed, 0));
  EXPECT_NO_THROW(check_table_config({}, "estimate", "f.yaml"));
}

TEST(TableConfig, BecomesOptionsOfTheLocator) {
  TableConfig c;
  c.source = "estimate";
  c.gravity = "fixed";
  c.filter = false;
  c.lowest_m = 0.3;
  c.highest_m = 0.9;
  auto o = locator_options(c, kFixed, 7);
  ASSERT_TRUE(o);
  EXPECT_EQ(o->origin, TableOrigin::kEstimate);
  EXPECT_EQ(o->prior, TableLocatorOptions::Prior::kFixed);
  EXPECT_FALSE(o->filter);
  EXPECT_EQ(o->estimate.lowest_m, 0.3);
  EXPECT_EQ(o->fixed.camera_height_m, 0.7);
  c.source = "dds";
  c.pose_topic = "camera_pose";
  c.world_frame = "world";
  c.max_age_ms = 50;
  c.surface_height_m = 0.75;
  c.tilt_deviation_deg = 1;
  o = locator_options(c, kFixed, 7);
  EXPECT_EQ(o->origin, TableOrigin::kDds);
  EXPECT_EQ(o->domain, 7U);
  EXPECT_EQ(o->pose_topic, "camera_pose");
  EXPECT_EQ(o->world_frame, "world");
  EXPECT_EQ(o->max_age, std::chrono::milliseconds(50));
  EXPECT_EQ(o->table_height_m, 0.75);
  EXPECT_NEAR(o->tilt_deviation_rad, 0.0174533, 1e-6);
  c.source = "fixed";
  EXPECT_EQ(locator_options(c, kFixed, 7)->origin, TableOrigin::kFixed);
}

TEST(TableConfig, ContradictionsAreErrors) {
  TableConfig c;
  c.source = "estimate";
  try {
    check_table_config(c, "none", "f.yaml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                testing::HasSubstr("f.yaml: table.source is estimate, but detect.table is none"));
  }
  c.lowest_m = 2;
  c.highest_m = 1;
  EXPECT_THROW(check_table_config(c, "frame", "f.yaml"), InputError);
}

}  // namespace
}  // namespace sextant
