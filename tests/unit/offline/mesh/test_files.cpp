// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/offline/mesh/test_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <numbers>
#include <sstream>

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr float kCorners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
constexpr std::uint16_t kTriangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

template <typename T>
void put(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::uint32_t add(Mesh& mesh, double x, double y, double z) {
  mesh.vertices.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
  mesh.normals.emplace_back(0, 0, 0);
  mesh.colours.emplace_back(1, 1, 1);
  mesh.uvs.emplace_back(0, 0);
  return static_cast<std::uint32_t>(mesh.vertices.size()) - 1;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "sextant_mesh_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::write(const std::string& name, const std::string& content) const {
  const fs::path file = path_ / name;
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

fs::path repository_file(const std::string& name) { return fs::path(SEXTANT_SOURCE_DIR) / name; }

std::string file_content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(in) << file;
  std::ostringstream content;
  content << in.rdbuf();
  return content.str();
}

std::string tetrahedron_ply() {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 255 255 255\n1 0 0 255 0 0\n0 2 0 0 255 0\n0 0 3 0 0 51\n"
      "90 90 90 0 0 0\n";  // no face uses this one
  for (const auto& t : kTriangles) text += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return text;
}

std::string tetrahedron_obj() {
  std::string text;
  for (const auto& p : kCorners) text += fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
  text += "vt 0.25 0.75\nvt 0.75 0.75\nvt 0.25 0.25\n";
  for (const auto& t : kTriangles) text += fmt::format("f {}/1 {}/2 {}/3\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

std::string tetrahedron_stl() {
  std::string text = "solid tetrahedron\n";
  for (const auto& t : kTriangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const auto v : t)
      text += fmt::format("vertex {} {} {}\n", kCorners[v][0], kCorners[v][1], kCorners[v][2]);
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid tetrahedron\n";
}

std::string tetrahedron_binary_stl() {
  std::string out(80, ' ');
  put(out, std::uint32_t{4});
  for (const auto& t : kTriangles) {
    for (int k = 0; k < 3; ++k) put(out, 0.0F);
    for (const auto v : t) out.append(reinterpret_cast<const char*>(kCorners[v]), 12);
    put(out, std::uint16_t{0});
  }
  return out;
}

std::string tetrahedron_gltf(const std::string& node_members) {
  std::string data;
  data.append(reinterpret_cast<const char*>(kCorners), sizeof kCorners);
  data.append(reinterpret_cast<const char*>(kTriangles), sizeof kTriangles);
  constexpr float kColours[4][3] = {{1, 1, 1}, {0.5F, 0, 0}, {0, 0.5F, 0}, {0, 0, 0.5F}};
  data.append(reinterpret_cast<const char*>(kColours), sizeof kColours);
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{}}}],)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"COLOR_0":2}},"indices":1}}]}}],)"
      R"("buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}},)"
      R"({{"buffer":0,"byteOffset":72,"byteLength":48}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,2,3]}},)"
      R"({{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}},)"
      R"({{"bufferView":2,"componentType":5126,"count":4,"type":"VEC3"}}]}})",
      node_members, data.size(), base64(data));
}

std::string tetrahedron_dae(const std::string& up_axis, const std::string& metres,
                            const std::string& node_matrix) {
  std::string positions;
  std::string indices;
  for (const auto& p : kCorners) positions += fmt::format("{} {} {} ", p[0], p[1], p[2]);
  for (const auto& t : kTriangles) indices += fmt::format("{} {} {} ", t[0], t[1], t[2]);
  return fmt::format(R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{}"/><up_axis>{}</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="12">{}</float_array>
<technique_common><accessor source="#a" count="4" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><matrix>{}</matrix>
<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)",
                     metres, up_axis, positions, indices, node_matrix);
}

Mesh box_mesh(double x, double y, double z) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    add(mesh, (i & 1) != 0 ? x / 2 : -x / 2, (i & 2) != 0 ? y / 2 : -y / 2, (i & 4) != 0 ? z / 2 : -z / 2);
  }
  mesh.parts.push_back({{{0, 2, 3},
                         {0, 3, 1},
                         {4, 5, 7},
                         {4, 7, 6},
                         {0, 1, 5},
                         {0, 5, 4},
                         {2, 6, 7},
                         {2, 7, 3},
                         {0, 4, 6},
                         {0, 6, 2},
                         {1, 3, 7},
                         {1, 7, 5}},
                        -1,
                        {1, 1, 1}});
  return mesh;
}

Mesh cylinder_mesh(double radius, double height, int sides) {
  Mesh mesh;
  MeshPart part;
  const std::uint32_t bottom = add(mesh, 0, 0, -height / 2);
  const std::uint32_t top = add(mesh, 0, 0, height / 2);
  for (int i = 0; i < sides; ++i) {
    const double turn = 2 * std::numbers::pi * i / sides;
    add(mesh, radius * std::cos(turn), radius * std::sin(turn), -height / 2);
    add(mesh, radius * std::cos(turn), radius * std::sin(turn), height / 2);
  }
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 + 2 * i;
    const std::uint32_t b = 2 + 2 * ((i + 1) % n);
    part.triangles.push_back({bottom, b, a});
    part.triangles.push_back({top, a + 1, b + 1});
    part.triangles.push_back({a, b, b + 1});
    part.triangles.push_back({a, b + 1, a + 1});
  }
  mesh.parts.push_back(part);
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh out = a;
  const auto shift = static_cast<std::uint32_t>(a.vertices.size());
  out.vertices.insert(out.vertices.end(), b.vertices.begin(), b.vertices.end());
  out.normals.insert(out.normals.end(), b.normals.begin(), b.normals.end());
  out.colours.insert(out.colours.end(), b.colours.begin(), b.colours.end());
  out.uvs.insert(out.uvs.end(), b.uvs.begin(), b.uvs.end());
  for (MeshPart part : b.parts) {
    for (auto& t : part.triangles) {
      for (std::uint32_t& v : t) v += shift;
    }
    out.parts.push_back(part);
  }
  return out;
}

Mesh moved(Mesh mesh, const Eigen::Vector3d& by) {
  for (Eigen::Vector3f& p : mesh.vertices) p += by.cast<float>();
  return mesh;
}

Mesh scaled(Mesh mesh, double by) {
  for (Eigen::Vector3f& p : mesh.vertices) p *= static_cast<float>(by);
  return mesh;
}

}  // namespace sextant
