// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/mesh_wire.h"

#include <cstring>
#include <type_traits>

namespace sextant {
namespace {

void append(std::vector<std::byte>& out, const void* data, std::size_t size) {
  const std::size_t at = out.size();
  out.resize(at + size);
  if (size != 0) std::memcpy(out.data() + at, data, size);
}

template <typename T>
void put(std::vector<std::byte>& out, const T& value) {
  append(out, &value, sizeof value);
}

template <typename T>
void put_all(std::vector<std::byte>& out, const std::vector<T>& values) {
  put(out, static_cast<std::uint64_t>(values.size()));
  append(out, values.data(), values.size() * sizeof(T));
}

// Takes values from the front; after the first that does not fit, ok() stays false.
class Taker {
 public:
  explicit Taker(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <typename T>
  T take() {
    T value{};
    if (rest_.size() < sizeof value) {
      ok_ = false;
      return value;
    }
    std::memcpy(static_cast<void*>(&value), rest_.data(), sizeof value);
    rest_ = rest_.subspan(sizeof value);
    return value;
  }

  template <typename T>
  void take_all(std::vector<T>& values) {
    const auto count = take<std::uint64_t>();
    if (!ok_ || count > rest_.size() / sizeof(T)) {
      ok_ = false;
      return;
    }
    values.resize(count);
    if (count != 0) std::memcpy(static_cast<void*>(values.data()), rest_.data(), count * sizeof(T));
    rest_ = rest_.subspan(count * sizeof(T));
  }

  bool take_image(cv::Mat& image) {
    const auto rows = take<std::int32_t>();
    const auto cols = take<std::int32_t>();
    constexpr std::int32_t kMost = 1 << 14;
    if (!ok_ || rows < 1 || cols < 1 || rows > kMost || cols > kMost) return ok_ = false;
    const std::size_t size = std::size_t{3} * static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
    if (rest_.size() < size) return ok_ = false;
    image.create(rows, cols, CV_8UC3);
    std::memcpy(image.data, rest_.data(), size);
    rest_ = rest_.subspan(size);
    return true;
  }

  bool ok() const { return ok_; }
  bool at_end() const { return rest_.empty(); }

 private:
  std::span<const std::byte> rest_;
  bool ok_ = true;
};

bool consistent(const Mesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  if (mesh.normals.size() != n || mesh.colours.size() != n || mesh.uvs.size() != n) return false;
  for (const MeshPart& part : mesh.parts) {
    if (part.texture < -1 || part.texture >= static_cast<int>(mesh.textures.size())) return false;
    for (const auto& triangle : part.triangles) {
      for (const std::uint32_t corner : triangle) {
        if (corner >= n) return false;
      }
    }
  }
  return true;
}

}  // namespace

std::vector<std::byte> bytes_from_mesh(const Mesh& mesh) {
  std::vector<std::byte> out;
  put_all(out, mesh.vertices);
  put_all(out, mesh.normals);
  put_all(out, mesh.colours);
  put_all(out, mesh.uvs);
  put(out, static_cast<std::uint64_t>(mesh.parts.size()));
  for (const MeshPart& part : mesh.parts) {
    put(out, static_cast<std::int32_t>(part.texture));
    put(out, part.diffuse);
    put_all(out, part.triangles);
  }
  put(out, static_cast<std::uint64_t>(mesh.textures.size()));
  for (const cv::Mat& image : mesh.textures) {
    put(out, static_cast<std::int32_t>(image.rows));
    put(out, static_cast<std::int32_t>(image.cols));
    append(out, image.data, image.total() * image.elemSize());
  }
  return out;
}

std::optional<Mesh> mesh_from_bytes(std::span<const std::byte> bytes) {
  Mesh mesh;
  Taker taker(bytes);
  taker.take_all(mesh.vertices);
  taker.take_all(mesh.normals);
  taker.take_all(mesh.colours);
  taker.take_all(mesh.uvs);
  for (auto parts = taker.take<std::uint64_t>(); taker.ok() && parts > 0; --parts) {
    MeshPart part;
    part.texture = taker.take<std::int32_t>();
    part.diffuse = taker.take<Eigen::Vector3f>();
    taker.take_all(part.triangles);
    mesh.parts.push_back(std::move(part));
  }
  for (auto textures = taker.take<std::uint64_t>(); taker.ok() && textures > 0; --textures) {
    cv::Mat image;
    if (taker.take_image(image)) mesh.textures.push_back(image);
  }
  if (!taker.ok() || !taker.at_end() || !consistent(mesh)) return std::nullopt;
  return mesh;
}

}  // namespace sextant
