// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/ply_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <vector>

#include "hal/image/file_bytes.h"

namespace sextant {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY is written in the machine's byte order");

template <typename T>
void append(std::vector<std::byte>& bytes, const T& value) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

void append(std::vector<std::byte>& bytes, const std::string& text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  bytes.insert(bytes.end(), first, first + text.size());
}

Eigen::Vector3f texture_at(const cv::Mat& texture, const Eigen::Vector2f& uv) {
  const auto wrap = [](float t, int size) {
    const float turns = t - std::floor(t);
    return std::clamp(static_cast<int>(turns * static_cast<float>(size)), 0, size - 1);
  };
  const cv::Vec3b c = texture.at<cv::Vec3b>(wrap(1.0F - uv.y(), texture.rows), wrap(uv.x(), texture.cols));
  return Eigen::Vector3f(c[0], c[1], c[2]) / 255.0F;
}

/// The first part that uses a vertex decides its look.
std::vector<Eigen::Vector3f> baked_colours(const Mesh& mesh) {
  std::vector<Eigen::Vector3f> colours = mesh.colours;
  std::vector<bool> done(mesh.vertices.size(), false);
  for (const MeshPart& part : mesh.parts) {
    for (const auto& triangle : part.triangles) {
      for (const std::uint32_t v : triangle) {
        if (done[v]) continue;
        done[v] = true;
        colours[v] = colours[v].cwiseProduct(part.diffuse);
        if (part.texture >= 0 && !mesh.textures[static_cast<std::size_t>(part.texture)].empty()) {
          colours[v] = colours[v].cwiseProduct(
              texture_at(mesh.textures[static_cast<std::size_t>(part.texture)], mesh.uvs[v]));
        }
      }
    }
  }
  return colours;
}

}  // namespace

void write_ply_mm(const std::filesystem::path& file, const Mesh& mesh, const RigidTransform& file_from_mesh) {
  std::vector<std::byte> bytes;
  bytes.reserve(256 + mesh.vertices.size() * 27 + mesh.triangle_count() * 13);
  append(bytes, fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                            "property float x\nproperty float y\nproperty float z\n"
                            "property float nx\nproperty float ny\nproperty float nz\n"
                            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                            "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                            mesh.vertices.size(), mesh.triangle_count()));
  const std::vector<Eigen::Vector3f> colours = baked_colours(mesh);
  const std::size_t first_byte = bytes.size();
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f p = (file_from_mesh * mesh.vertices[i].cast<double>() * 1000.0).cast<float>();
    const Eigen::Vector3f n = (file_from_mesh.linear() * mesh.normals[i].cast<double>()).cast<float>();
    for (const float f : {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()}) append(bytes, f);
    for (int c = 0; c < 3; ++c) {
      append(bytes, static_cast<unsigned char>(std::lround(255.0F * std::clamp(colours[i][c], 0.0F, 1.0F))));
    }
  }
  // Some readers (assimp 5.2) skip what looks like white space after the header: no coordinate starts with
  // it, at the price of its last digit.
  if (bytes.size() > first_byte && std::isspace(static_cast<int>(bytes[first_byte])) != 0)
    bytes[first_byte] ^= std::byte{1} << 5;
  for (const MeshPart& part : mesh.parts) {
    for (const auto& triangle : part.triangles) {
      append(bytes, static_cast<unsigned char>(3));
      for (const std::uint32_t v : triangle) append(bytes, v);
    }
  }
  write_file_bytes(file, bytes);
}

}  // namespace sextant
