// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/writers.h"

#include <fmt/format.h>
#include <spng.h>

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "offline/mesh/bundled/shapes.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

static_assert(std::endian::native == std::endian::little);

void append(FileBytes& out, const void* data, std::size_t size) {
  const std::size_t at = out.size();
  out.resize(at + size);
  if (size != 0) std::memcpy(out.data() + at, data, size);
}
template <typename T>
void put(FileBytes& out, const T& value) {
  append(out, &value, sizeof value);
}
void put_text(FileBytes& out, const std::string& text) { append(out, text.data(), text.size()); }

std::uint8_t byte_of(float unit) { return static_cast<std::uint8_t>(unit * 255 + 0.5F); }

// As glTF stores base colours.
float linear_from_srgb(float c) { return c <= 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F); }

// The binary part of a GLB and what describes it.
struct GlbBuilder {
  FileBytes binary;
  nlohmann::json views = nlohmann::json::array();
  nlohmann::json accessors = nlohmann::json::array();

  std::size_t view(const FileBytes& bytes) {
    views.push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", bytes.size()}});
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    binary.resize((binary.size() + 3) / 4 * 4);
    return views.size() - 1;
  }
  std::size_t accessor(const FileBytes& bytes, int component, const char* type, std::size_t count) {
    accessors.push_back(
        {{"bufferView", view(bytes)}, {"componentType", component}, {"type", type}, {"count", count}});
    return accessors.size() - 1;
  }
};

constexpr int kGlFloat = 5126;
constexpr int kGlUnsignedInt = 5125;

}  // namespace

FileBytes ply_bytes(const Mesh& mesh) {
  FileBytes out;
  put_text(out, fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
                            "property float x\nproperty float y\nproperty float z\n"
                            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                            "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                            mesh.vertices.size(), mesh.triangle_count()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    append(out, mesh.vertices[i].data(), 12);
    for (int k = 0; k < 3; ++k) put(out, byte_of(mesh.colours[i][k]));
  }
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      put(out, std::uint8_t{3});
      append(out, t.data(), 12);
    }
  }
  return out;
}

FileBytes stl_bytes(const Mesh& mesh, const std::string& title) {
  FileBytes out;
  std::string header = title;
  header.resize(80, ' ');
  put_text(out, header);
  put(out, static_cast<std::uint32_t>(mesh.triangle_count()));
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      const Eigen::Vector3f& a = mesh.vertices[t[0]];
      const Eigen::Vector3d n =
          (mesh.vertices[t[1]] - a).cast<double>().cross((mesh.vertices[t[2]] - a).cast<double>());
      const Eigen::Vector3d unit = n.normalized();
      for (int k = 0; k < 3; ++k) put(out, rounded(unit[k]));
      for (const std::uint32_t v : t) append(out, mesh.vertices[v].data(), 12);
      put(out, std::uint16_t{0});
    }
  }
  return out;
}

FileBytes obj_bytes(const Mesh& mesh, const std::string& material_file) {
  std::string text = fmt::format("mtllib {}\nusemtl print\n", material_file);
  for (const auto& p : mesh.vertices) text += fmt::format("v {:g} {:g} {:g}\n", p.x(), p.y(), p.z());
  for (const auto& t : mesh.uvs) text += fmt::format("vt {:.6f} {:.6f}\n", t.x(), t.y());
  for (const auto& n : mesh.normals) text += fmt::format("vn {:g} {:g} {:g}\n", n.x(), n.y(), n.z());
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      text += fmt::format("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
  }
  FileBytes out;
  put_text(out, text);
  return out;
}

FileBytes mtl_bytes(const std::string& texture_file) {
  FileBytes out;
  put_text(out, fmt::format("newmtl print\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nmap_Kd {}\n", texture_file));
  return out;
}

FileBytes glb_bytes(const Mesh& mesh, double metres_per_unit) {
  GlbBuilder glb;
  FileBytes positions;
  FileBytes normals;
  FileBytes uvs;
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d p = mesh.vertices[i].cast<double>() * metres_per_unit;
    const Eigen::Vector3f y_up = Eigen::Vector3d(p.x(), p.z(), -p.y()).cast<float>();
    const Eigen::Vector3f& n = mesh.normals[i];
    box.extend(y_up);
    append(positions, y_up.data(), 12);
    for (const float c : {n.x(), n.z(), -n.y()}) put(normals, rounded(static_cast<double>(c)));
    put(uvs, mesh.uvs[i].x());
    put(uvs, 1 - mesh.uvs[i].y());
  }
  const std::size_t count = mesh.vertices.size();
  const std::size_t position = glb.accessor(positions, kGlFloat, "VEC3", count);
  glb.accessors[position]["min"] = {box.min().x(), box.min().y(), box.min().z()};
  glb.accessors[position]["max"] = {box.max().x(), box.max().y(), box.max().z()};
  const std::size_t normal = glb.accessor(normals, kGlFloat, "VEC3", count);
  const std::size_t uv = glb.accessor(uvs, kGlFloat, "VEC2", count);

  nlohmann::json json;
  json["asset"] = {{"version", "2.0"}, {"generator", "sextant-make-meshes"}};
  json["scene"] = 0;
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = {{{"mesh", 0}}};
  for (const cv::Mat& image : mesh.textures) {
    json["images"].push_back({{"bufferView", glb.view(png_bytes(image))}, {"mimeType", "image/png"}});
    json["textures"].push_back({{"source", json["images"].size() - 1}});
  }
  for (const MeshPart& part : mesh.parts) {
    FileBytes indices;
    for (const auto& t : part.triangles) append(indices, t.data(), 12);
    const std::size_t index = glb.accessor(indices, kGlUnsignedInt, "SCALAR", 3 * part.triangles.size());
    nlohmann::json look = {
        {"metallicFactor", 0}, {"roughnessFactor", 1}, {"baseColorFactor", nlohmann::json::array()}};
    for (const float c : {part.diffuse.x(), part.diffuse.y(), part.diffuse.z(), 1.0F}) {
      // Six digits: more would show the machine's power function.
      look["baseColorFactor"].push_back(std::round(static_cast<double>(linear_from_srgb(c)) * 1e6) / 1e6);
    }
    if (part.texture >= 0) look["baseColorTexture"] = {{"index", part.texture}};
    json["materials"].push_back({{"pbrMetallicRoughness", look}});
    json["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
         {"indices", index},
         {"material", json["materials"].size() - 1}});
  }
  json["bufferViews"] = glb.views;
  json["accessors"] = glb.accessors;
  json["buffers"] = {{{"byteLength", glb.binary.size()}}};

  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  FileBytes out;
  put_text(out, "glTF");
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + glb.binary.size()));
  put(out, static_cast<std::uint32_t>(text.size()));
  put_text(out, "JSON");
  put_text(out, text);
  put(out, static_cast<std::uint32_t>(glb.binary.size()));
  append(out, "BIN\0", 4);
  append(out, glb.binary.data(), glb.binary.size());
  return out;
}

FileBytes png_bytes(const cv::Mat& image) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  const auto check = [](int code) {
    if (code != 0) throw InputError("PNG encoder", spng_strerror(code));
  };
  check(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  check(spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 9));
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.cols);
  header.height = static_cast<std::uint32_t>(image.rows);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR;
  check(spng_set_ihdr(context.get(), &header));
  check(spng_encode_image(context.get(), image.data, image.total() * image.elemSize(), SPNG_FMT_PNG,
                          SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int error = 0;
  const std::unique_ptr<void, void (*)(void*)> data(spng_get_png_buffer(context.get(), &size, &error),
                                                    std::free);
  check(error);
  FileBytes out;
  append(out, data.get(), size);
  return out;
}

}  // namespace sextant
