// SPDX-License-Identifier: Apache-2.0
// What is no mesh at all: one clear line each.
#include "offline/mesh/mesh_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <cstring>
#include <fstream>

#include "tests/unit/offline/mesh/test_files.h"

namespace sextant {
namespace {

using testing::HasSubstr;

class MeshReader : public testing::Test {
 protected:
  std::string error_of(const std::string& name, const std::string& content) {
    const auto file = folder_.write(name, content);
    const std::string error = input_error_of([&] { read_mesh(file); });
    EXPECT_THAT(error, HasSubstr(file.string()));
    return error;
  }
  static std::string ply(const std::string& vertices, const std::string& faces, int vertex_count,
                         int face_count) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex_count) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
           std::to_string(face_count) + "\nproperty list uchar int vertex_indices\nend_header\n" + vertices +
           faces;
  }
  TemporaryFolder folder_;
};

TEST_F(MeshReader, FilesThatAreNone) {
  EXPECT_THAT(input_error_of([&] { read_mesh(folder_.path() / "none.ply"); }), HasSubstr("is not there"));
  std::filesystem::create_directory(folder_.path() / "folder.ply");
  EXPECT_THAT(input_error_of([&] { read_mesh(folder_.path() / "folder.ply"); }), HasSubstr("is a folder"));
  ASSERT_EQ(mkfifo((folder_.path() / "pipe.ply").c_str(), 0600), 0);
  EXPECT_THAT(input_error_of([&] { read_mesh(folder_.path() / "pipe.ply"); }),
              HasSubstr("not a regular file"));
  EXPECT_THAT(error_of("e.stl", ""), HasSubstr("is empty"));
  EXPECT_THAT(error_of("t.txt", tetrahedron_ply()), HasSubstr("is not a mesh by its name"));
  EXPECT_THAT(error_of("t.3ds", tetrahedron_ply()), HasSubstr("is not a mesh by its name"));
}

TEST_F(MeshReader, TheNameDecidesTheImporter) {
  error_of("ply.stl", tetrahedron_ply());
  error_of("obj.ply", tetrahedron_obj());
  error_of("stl.dae", tetrahedron_stl());
  error_of("dae.glb", tetrahedron_dae());
}

TEST_F(MeshReader, MeshesWithoutSurface) {
  EXPECT_THAT(error_of("points.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "", 3, 0)),
              testing::AnyOf(HasSubstr("no triangles"), HasSubstr("cannot be read")));
  EXPECT_THAT(error_of("line.ply", ply("0 0 0\n1 1 1\n2 2 2\n", "3 0 1 2\n", 3, 1)),
              HasSubstr("has no area"));
  EXPECT_THAT(error_of("point.ply", ply("1 1 1\n1 1 1\n1 1 1\n", "3 0 1 2\n", 3, 1)),
              HasSubstr("has no area"));
  EXPECT_THAT(error_of("twice.ply", ply("0 0 0\n1 1 1\n0 2 2\n", "3 0 1 1\n", 3, 1)),
              HasSubstr("has no triangles"));
}

TEST_F(MeshReader, NumbersThatAreNone) {
  std::string stl = tetrahedron_binary_stl();
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38F}) {
    std::memcpy(stl.data() + 84 + 50 + 12, &bad, sizeof bad);
    EXPECT_THAT(error_of("bad.stl", stl), testing::AnyOf(HasSubstr("not a number"), HasSubstr("10^9")));
  }
  error_of("nan.ply", ply("nan 0 0\n1 0 0\n0 1 0\n", "3 0 1 2\n", 3, 1));
}

TEST_F(MeshReader, IndicesThatPointNowhere) {
  EXPECT_THAT(error_of("i.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "3 0 1 7\n", 3, 1)), HasSubstr(""));
  error_of("n.ply", ply("0 0 0\n1 0 0\n0 1 0\n", "3 0 1 -1\n", 3, 1));
  error_of("o.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
}

TEST_F(MeshReader, TooManyTrianglesBeforeReadingThem) {
  // Sparse files: nothing of them is ever stored or read.
  const auto stl = folder_.write("big.stl", std::string(80, ' '));
  const std::uint32_t count = 5'000'000;
  std::ofstream(stl, std::ios::binary | std::ios::app).write(reinterpret_cast<const char*>(&count), 4);
  std::filesystem::resize_file(stl, 84 + std::uintmax_t{50} * count);
  EXPECT_THAT(input_error_of([&] { read_mesh(stl); }), HasSubstr("more than 2,000,000 triangles"));
  const auto promising = folder_.write("big.ply", ply("0 0 0\n", "", 1, 5'000'000));
  EXPECT_THAT(input_error_of([&] { read_mesh(promising); }), HasSubstr("shorter than its header promises"));
  std::filesystem::resize_file(promising, 20'000'000);
  EXPECT_THAT(input_error_of([&] { read_mesh(promising); }), HasSubstr("more than 2,000,000 triangles"));
  const auto huge = folder_.write("huge.obj", "v 0 0 0\n");
  std::filesystem::resize_file(huge, std::uintmax_t{600} << 20);
  EXPECT_THAT(input_error_of([&] { read_mesh(huge); }), HasSubstr("larger than 512 MiB"));
}

// The file does not say how many there are: instances multiply 4 triangles by 600,000.
TEST_F(MeshReader, TooManyTrianglesByInstances) {
  std::string gltf = tetrahedron_gltf();
  std::string nodes = R"("nodes":[{"mesh":0})";
  std::string roots = R"("scenes":[{"nodes":[0)";
  for (int i = 1; i < 600'000; ++i) {
    nodes += R"(,{"mesh":0})";
    roots += fmt::format(",{}", i);
  }
  const auto replace = [&](const std::string& what, const std::string& with) {
    const std::size_t at = gltf.find(what);
    ASSERT_NE(at, std::string::npos);
    gltf.replace(at, what.size(), with);
  };
  replace(R"("nodes":[{"mesh":0}])", nodes + "]");
  replace(R"("scenes":[{"nodes":[0]}])", roots + "]}]");
  EXPECT_THAT(error_of("many.gltf", gltf),
              testing::AnyOf(HasSubstr("more than 2,000,000 triangles"), HasSubstr("took too")));
}

// assimp spins for ever on the first of these, so they must not reach it.
TEST_F(MeshReader, PlyHeadersAreReadStrictly) {
  const std::string good = tetrahedron_ply();
  EXPECT_THAT(error_of("a.ply", good.substr(0, good.find("end_header"))), HasSubstr("header without end"));
  EXPECT_THAT(error_of("b.ply", good.substr(0, good.size() / 2)),
              testing::AnyOf(HasSubstr("header"), HasSubstr("shorter")));
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return error_of("c.ply", text);
  };
  EXPECT_THAT(changed("ply\n", "plx\n"), HasSubstr("does not begin with 'ply'"));
  EXPECT_THAT(changed("ascii", "ascci"), HasSubstr("unknown format"));
  EXPECT_THAT(changed("format ascii 1.0\n", ""), HasSubstr("does not say its format"));
  EXPECT_THAT(changed("float x", "flaot x"), HasSubstr("unknown type"));
  EXPECT_THAT(changed("vertex 5", "vertex -5"), HasSubstr("bad count"));
  EXPECT_THAT(changed("vertex 5", "vertex 99999999999999999999999"), HasSubstr("bad count"));
  EXPECT_THAT(changed("vertex 5", "vertex 500"), HasSubstr("shorter than its header promises"));
  EXPECT_THAT(changed("element vertex 5", "elemant vertex 5"), HasSubstr("unknown line"));
  EXPECT_THAT(changed("element vertex 5\n", ""), HasSubstr("bad property"));
  // What others write is read: comments, carriage returns, more elements and properties.
  std::string other = good;
  other.replace(other.find("element vertex"), 0, "comment made by hand\nobj_info none\n");
  EXPECT_EQ(read_mesh(folder_.write("d.ply", other)).triangle_count(), 4U);
  std::string windows;
  for (const char c : good) windows += c == '\n' ? std::string(1, '\r') + '\n' : std::string(1, c);
  EXPECT_EQ(read_mesh(folder_.write("e.ply", windows)).triangle_count(), 4U);
}

TEST_F(MeshReader, ALimitThatIsTooSmallEndsTheChildAndNothingElse) {
  const auto file = repository_file("data/meshes/bottle.ply");
  IsolationLimits limits;
  limits.answer_bytes = 1000;
  EXPECT_THAT(input_error_of([&] { read_mesh(file, 0.001, limits); }), HasSubstr("gave too much data"));
  EXPECT_EQ(read_mesh(file, 0.001).triangle_count(), 9136U);
}

TEST_F(MeshReader, SameBytesSameMesh) {
  for (const char* name : {"data/meshes/bottle.ply", "data/meshes/can.glb", "data/meshes/printed_box.obj"}) {
    const Mesh a = read_mesh(repository_file(name));
    const Mesh b = read_mesh(repository_file(name));
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.parts[0].triangles, b.parts[0].triangles);
  }
}

TEST_F(MeshReader, HashIsOfTheBytes) {
  const auto file = folder_.write("a.ply", tetrahedron_ply());
  const std::uint64_t before = mesh_file_hash(file);
  EXPECT_EQ(before, mesh_file_hash(folder_.write("b.ply", tetrahedron_ply())));
  EXPECT_NE(before, mesh_file_hash(folder_.write("b.ply", tetrahedron_ply() + "\n")));
}

}  // namespace
}  // namespace sextant
