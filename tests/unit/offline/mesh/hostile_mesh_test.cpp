// SPDX-License-Identifier: Apache-2.0
// Damaged files of every format: a usable mesh or one InputError, never a crash, a hang or another exception.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "offline/mesh/bundled/bundled_meshes.h"
#include "offline/mesh/mesh_reader.h"
#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

// What a mesh must be whoever wrote its file.
void expect_sound(const Mesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  ASSERT_GT(mesh.triangle_count(), 0U);
  ASSERT_EQ(mesh.normals.size(), n);
  ASSERT_EQ(mesh.colours.size(), n);
  ASSERT_EQ(mesh.uvs.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    ASSERT_TRUE(mesh.vertices[i].allFinite());
    ASSERT_NEAR(mesh.normals[i].norm(), 1, 1e-3);
    ASSERT_TRUE((mesh.colours[i].array() >= 0).all() && (mesh.colours[i].array() <= 1).all());
    ASSERT_TRUE(mesh.uvs[i].allFinite());
  }
  for (const MeshPart& part : mesh.parts) {
    ASSERT_LT(part.texture, static_cast<int>(mesh.textures.size()));
    for (const auto& t : part.triangles) {
      ASSERT_LT(std::max({t[0], t[1], t[2]}), n);
    }
  }
}

struct Outcome {
  int meshes = 0;
  int refused = 0;
};

class HostileMesh : public testing::Test {
 protected:
  void try_reading(const std::filesystem::path& file) {
    IsolationLimits limits;
    limits.cpu_s = 1;  // more than any of these small files takes
    limits.memory_bytes = std::size_t{1} << 30;
    try {
      expect_sound(read_mesh(file, 1, limits));
      ++outcome_.meshes;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++outcome_.refused;
    }
  }

  // `rounds` damaged copies of `content`, read as `read_as` (another file may refer to the damaged one).
  void damage(const std::string& name, const std::string& content, int rounds, std::string read_as = "") {
    if (read_as.empty()) read_as = name;
    std::mt19937_64 random(content.size());
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    for (int i = 0; i < rounds; ++i) {
      std::string bad = content;
      switch (i % 4) {
        case 0:
          bad.resize(1 + below(bad.size() - 1));
          break;
        case 1:
          for (int k = 0; k < 4; ++k) bad[below(bad.size())] = static_cast<char>(random());
          break;
        case 2:  // near the front, where counts and structure live
          for (int k = 0; k < 3; ++k) {
            bad[below(std::min<std::size_t>(bad.size(), 600))] ^= static_cast<char>(1U << below(8));
          }
          break;
        default: {  // a piece lands elsewhere
          const std::size_t length = 1 + below(std::min<std::size_t>(bad.size() / 2, 64));
          const std::size_t from = below(bad.size() - length);
          bad.replace(below(bad.size() - length), length, content.substr(from, length));
        }
      }
      folder_.write(name, bad);
      try_reading(folder_.path() / read_as);
      if (HasFatalFailure()) return;
    }
    // Damage must have mattered: most of it is found.
    EXPECT_GT(outcome_.refused, rounds / 10) << name;
  }

  static std::string text_of(const FileBytes& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  TemporaryFolder folder_;
  Outcome outcome_;
};

constexpr int kRounds = 160;

TEST_F(HostileMesh, PlyText) { damage("t.ply", tetrahedron_ply(), kRounds); }
TEST_F(HostileMesh, ObjText) { damage("t.obj", tetrahedron_obj(), kRounds); }
TEST_F(HostileMesh, StlText) { damage("t.stl", tetrahedron_stl(), kRounds); }
TEST_F(HostileMesh, StlBinary) { damage("t.stl", tetrahedron_binary_stl(), kRounds); }
TEST_F(HostileMesh, Gltf) { damage("t.gltf", tetrahedron_gltf(), kRounds); }
TEST_F(HostileMesh, Dae) { damage("t.dae", tetrahedron_dae(), kRounds); }
TEST_F(HostileMesh, GlbWithTexture) { damage("c.glb", text_of(glb_bytes(can(), 0.001)), kRounds); }
TEST_F(HostileMesh, PlyBinary) { damage("b.ply", text_of(ply_bytes(bottle())), kRounds); }

TEST_F(HostileMesh, MaterialAndTexture) {
  for (const auto& [name, bytes] : bundled_mesh_files()) {
    if (name.starts_with("printed_box")) folder_.write(name, text_of(bytes));
  }
  damage("printed_box.png", file_content(folder_.path() / "printed_box.png"), kRounds / 4, "printed_box.obj");
  for (const auto& [name, bytes] : bundled_mesh_files()) {
    if (name.starts_with("printed_box")) folder_.write(name, text_of(bytes));
  }
  outcome_ = {};
  damage("printed_box.mtl", file_content(folder_.path() / "printed_box.mtl"), kRounds / 4, "printed_box.obj");
}

TEST_F(HostileMesh, EveryTruncationOfASmallFile) {
  const std::string whole = tetrahedron_binary_stl();
  for (std::size_t size = 1; size < whole.size(); size += 3) {
    const auto file = folder_.write("t.stl", whole.substr(0, size));
    EXPECT_THROW(read_mesh(file), InputError) << size;
  }
}

TEST_F(HostileMesh, NestedNodesDoNotOverflowTheStack) {
  // 200,000 Collada nodes inside each other.
  std::string dae = tetrahedron_dae();
  std::string open;
  std::string close;
  for (int i = 0; i < 200'000; ++i) {
    open += "<node>";
    close += "</node>";
  }
  dae.insert(dae.find("<node id"), open);
  dae.insert(dae.find("</visual_scene>"), close);
  try_reading(folder_.write("deep.dae", dae));
  EXPECT_EQ(outcome_.meshes + outcome_.refused, 1);
}

}  // namespace
}  // namespace sextant
