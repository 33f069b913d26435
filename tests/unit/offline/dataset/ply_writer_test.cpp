// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/ply_writer.h"

#include <gtest/gtest.h>

#include "offline/mesh/mesh_reader.h"
#include "tests/support/simple_objects.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

TEST(PlyWriter, WhatItWritesIsReadBackWhateverTheFirstByteIs) {
  const TemporaryFolder folder;
  // The first coordinate is -hx in mm: -0.04 ends in byte 0x0A (a line end), -0.14 in 0x29, -0.55 in 0xCD.
  for (const double hx_mm : {0.04, 0.14, 0.55, 40.0}) {
    const Mesh mesh = box_object_mesh(hx_mm / 1000, 0.03, 0.05);
    write_ply_mm(folder / "box.ply", mesh, RigidTransform::Identity());
    const Mesh read = read_mesh(folder / "box.ply", 0.001);
    ASSERT_EQ(mesh.triangle_count(), read.triangle_count()) << hx_mm;
    float widest = 0;
    for (const Eigen::Vector3f& v : read.vertices) widest = std::max(widest, std::abs(v.x()));
    EXPECT_NEAR(hx_mm / 1000, widest, 1e-8) << hx_mm;
  }
}

}  // namespace
}  // namespace sextant
