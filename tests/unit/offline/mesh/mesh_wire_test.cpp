// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/mesh_wire.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

TEST(MeshWire, RoundTrip) {
  const Mesh mesh = can();
  const std::optional<Mesh> back = mesh_from_bytes(bytes_from_mesh(mesh));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->vertices, mesh.vertices);
  EXPECT_EQ(back->normals, mesh.normals);
  EXPECT_EQ(back->colours, mesh.colours);
  EXPECT_EQ(back->uvs, mesh.uvs);
  ASSERT_EQ(back->parts.size(), mesh.parts.size());
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    EXPECT_EQ(back->parts[i].triangles, mesh.parts[i].triangles);
    EXPECT_EQ(back->parts[i].texture, mesh.parts[i].texture);
    EXPECT_EQ(back->parts[i].diffuse, mesh.parts[i].diffuse);
  }
  ASSERT_EQ(back->textures.size(), 1U);
  ASSERT_EQ(back->textures[0].size(), mesh.textures[0].size());
  EXPECT_EQ(std::memcmp(back->textures[0].data, mesh.textures[0].data, mesh.textures[0].total() * 3), 0);
}

TEST(MeshWire, EveryTruncationIsNoticed) {
  const std::vector<std::byte> bytes = bytes_from_mesh(box_mesh(1, 2, 3));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(mesh_from_bytes(std::span(bytes).first(size))) << size;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(mesh_from_bytes(longer));
}

TEST(MeshWire, WhatIsAcceptedIsConsistent) {
  const std::vector<std::byte> bytes = bytes_from_mesh(box_mesh(1, 2, 3));
  std::mt19937_64 random(5);
  int accepted = 0;
  for (int i = 0; i < 5000; ++i) {
    std::vector<std::byte> bad = bytes;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = static_cast<std::byte>(random());
    const std::optional<Mesh> mesh = mesh_from_bytes(bad);
    if (!mesh) continue;
    ++accepted;
    ASSERT_EQ(mesh->normals.size(), mesh->vertices.size());
    for (const MeshPart& part : mesh->parts) {
      ASSERT_LT(part.texture, static_cast<int>(mesh->textures.size()));
      for (const auto& t : part.triangles) {
        for (const auto v : t) {
          ASSERT_LT(v, mesh->vertices.size());
        }
      }
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, 5000);
}

}  // namespace
}  // namespace sextant
