// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/mesh_reader.h"

#include <xxhash.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>

#include "offline/mesh/mesh_folder.h"
#include "offline/mesh/mesh_import.h"
#include "offline/mesh/mesh_wire.h"
#include "offline/mesh/normals.h"
#include "offline/mesh/ply_header.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

// First byte of the child's answer.
constexpr std::byte kMeshFollows{'M'};
constexpr std::byte kErrorFollows{'E'};

void check_file(const fs::path& file) {
  const std::string where = file.string();
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw InputError(where, "is not there", "check the path");
  if (fs::is_directory(status)) throw InputError(where, "is a folder", "give a mesh file");
  if (!fs::is_regular_file(status)) throw InputError(where, "is not a regular file", "give a mesh file");
  if (mesh_format(file).empty()) {
    throw InputError(where, "is not a mesh by its name", "give a .ply, .obj, .stl, .gltf, .glb or .dae file");
  }
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw InputError(where, "cannot be read: " + error.message(), "check its permissions");
  if (size == 0) throw InputError(where, "is empty", "export it again");
  if (size > kMaxMeshFileBytes) throw InputError(where, "is larger than 512 MiB", "simplify the mesh first");
}

// Triangles that a PLY or binary STL says it has, 0 where it does not say: spares reading it in vain.
std::uint64_t declared_triangles(const fs::path& file) {
  if (mesh_format(file) == "ply") return read_ply_header(file).faces;
  std::ifstream in(file, std::ios::binary);
  std::array<char, 84> head{};
  if (mesh_format(file) != "stl" || !in.read(head.data(), head.size())) return 0;
  std::uint32_t count = 0;
  std::memcpy(&count, head.data() + 80, sizeof count);
  return fs::file_size(file) == 84 + std::uintmax_t{50} * count ? count : 0;
}

std::vector<std::byte> import_as_bytes(const fs::path& file) {
  std::vector<std::byte> answer;
  const auto fail = [&](const std::string& text) {
    answer.assign(1, kErrorFollows);
    const auto* data = reinterpret_cast<const std::byte*>(text.data());
    answer.insert(answer.end(), data, data + text.size());
  };
  try {
    const Mesh mesh = import_mesh(file);
    answer = bytes_from_mesh(mesh);
    answer.insert(answer.begin(), kMeshFollows);
  } catch (const InputError& error) {
    fail(error.what());
  } catch (const std::bad_alloc&) {
    fail(file.string() + ": needs too much memory; simplify the mesh first");
  } catch (const std::exception& error) {
    fail(file.string() + ": cannot be read: " + error.what() + "; export it again");
  }
  return answer;
}

// A line from the child: printable, and not endless.
std::string cleaned(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes.first(std::min<std::size_t>(bytes.size(), 1000))) {
    const char c = static_cast<char>(b);
    text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return text;
}

Mesh import_isolated(const fs::path& file, const IsolationLimits& limits) {
  const IsolatedAnswer answer = run_isolated([&] { return import_as_bytes(file); }, limits);
  if (!answer.failure.empty() || answer.bytes.empty()) {
    throw InputError(file.string(),
                     "reading it " + (answer.failure.empty() ? "gave nothing" : answer.failure),
                     "the file is damaged, hostile or too complex: export it again");
  }
  const std::span<const std::byte> rest = std::span(answer.bytes).subspan(1);
  if (answer.bytes.front() == kMeshFollows) {
    if (std::optional<Mesh> mesh = mesh_from_bytes(rest)) return *std::move(mesh);
  } else if (answer.bytes.front() == kErrorFollows) {
    throw InputError("", cleaned(rest));
  }
  throw InputError(file.string(), "reading it gave nonsense",
                   "the file is damaged or hostile: export it again");
}

// Drops vertices that no triangle uses, triangles without three different corners, and empty parts.
Mesh compacted(const Mesh& mesh) {
  constexpr std::uint32_t kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> place(mesh.vertices.size(), kUnused);
  Mesh out;
  out.textures = mesh.textures;
  for (const MeshPart& part : mesh.parts) {
    MeshPart kept{{}, part.texture, part.diffuse};
    for (std::array<std::uint32_t, 3> triangle : part.triangles) {
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) continue;
      for (std::uint32_t& corner : triangle) {
        std::uint32_t& to = place[corner];
        if (to == kUnused) {
          to = static_cast<std::uint32_t>(out.vertices.size());
          out.vertices.push_back(mesh.vertices[corner]);
          out.normals.push_back(mesh.normals[corner]);
          out.colours.push_back(mesh.colours[corner]);
          out.uvs.push_back(mesh.uvs[corner]);
        }
        corner = to;
      }
      kept.triangles.push_back(triangle);
    }
    if (!kept.triangles.empty()) out.parts.push_back(std::move(kept));
  }
  return out;
}

void check_shape(const Mesh& mesh, const std::string& where) {
  if (mesh.triangle_count() == 0)
    throw InputError(where, "has no triangles", "export it with faces, not points");
  if (mesh.triangle_count() > kMaxTriangles)
    throw InputError(where, "has more than 2,000,000 triangles", "simplify it");
  float largest = 0;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    if (!p.allFinite()) throw InputError(where, "has a vertex that is not a number", "export it again");
    largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  constexpr float kBeyondAnyUnit = 1e9F;
  if (largest > kBeyondAnyUnit)
    throw InputError(where, "has a vertex 10^9 away from the origin", "export it again");
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.vertices) box.extend(p);
  const double diagonal = box.diagonal().cast<double>().norm();
  double area = 0;
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
      area +=
          0.5 * (mesh.vertices[t[1]].cast<double>() - a).cross(mesh.vertices[t[2]].cast<double>() - a).norm();
    }
  }
  if (!(area > 1e-6 * diagonal * diagonal))
    throw InputError(where, "has no area", "export it with its surface");
}

}  // namespace

Mesh read_mesh(const fs::path& file, double metres_per_unit, const IsolationLimits& limits) {
  check_file(file);
  if (declared_triangles(file) > kMaxTriangles) {
    throw InputError(file.string(), "has more than 2,000,000 triangles",
                     "simplify it first (10,000 to 100,000 are plenty)");
  }
  Mesh mesh = compacted(import_isolated(file, limits));
  check_shape(mesh, file.string());
  for (Eigen::Vector3f& p : mesh.vertices) p = (p.cast<double>() * metres_per_unit).cast<float>();
  complete_normals(mesh);
  share_equal_vertices(mesh);
  return mesh;
}

std::uint64_t mesh_file_hash(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> chunk(1 << 16);
  while (in) {
    in.read(chunk.data(), static_cast<std::streamsize>(chunk.size()));
    XXH3_64bits_update(state.get(), chunk.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!in.eof()) throw InputError(file.string(), "cannot be read", "check its permissions");
  return XXH3_64bits_digest(state.get());
}

}  // namespace sextant
