// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/mesh_folder.h"

#include <algorithm>
#include <cctype>
#include <fstream>

#include "runtime/base/error.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxRemembered = 16;

void remember(std::vector<std::string>& names, const std::string& name) {
  if (names.size() < kMaxRemembered) names.push_back(name.substr(0, 200));
}

bool leads_out(const fs::path& relative) {
  const std::string text = relative.generic_string();
  const bool drive =
      text.size() > 1 && text[1] == ':' && std::isalpha(static_cast<unsigned char>(text[0])) != 0;
  return relative.is_absolute() || drive ||
         (!relative.empty() && *relative.lexically_normal().begin() == "..");
}

bool is_inside(const fs::path& folder, const fs::path& file) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

}  // namespace

MeshFolder::MeshFolder(const fs::path& mesh_file)
    : mesh_file_(mesh_file.string()),
      folder_(fs::canonical(mesh_file.has_parent_path() ? mesh_file.parent_path() : fs::path("."))) {}

fs::path MeshFolder::resolve(const std::string& name) const {
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  const fs::path relative(slashes);
  if (leads_out(relative)) {
    remember(refused_, name);
    return {};
  }
  std::error_code error;
  const fs::path file = fs::canonical(folder_ / relative, error);
  if (error || !fs::is_regular_file(file, error)) {
    remember(missing_, name);
    return {};
  }
  if (!is_inside(folder_, file)) {
    remember(refused_, name);
    return {};
  }
  return file;
}

std::vector<std::byte> MeshFolder::read(const std::string& name) const {
  const fs::path file = resolve(name);
  if (file.empty()) complain(name);
  const std::uintmax_t size = fs::file_size(file);
  if (size > kMaxMeshFileBytes)
    throw InputError(file.string(), "is larger than 512 MiB", "use a smaller file");
  std::vector<std::byte> bytes(size);
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (!in) throw InputError(file.string(), "cannot be read", "check its permissions");
  return bytes;
}

void MeshFolder::complain(const std::string& extension) const {
  if (!refused_.empty()) {
    throw InputError(mesh_file_, "refers to '" + refused_.front() + "', outside of the mesh's folder",
                     "put that file beside the mesh and name it without a path");
  }
  for (const std::string& name : missing_) {
    if (!name.ends_with(extension)) continue;
    throw InputError(mesh_file_, "refers to '" + name + "', which is not there",
                     "put that file beside the mesh or remove the reference");
  }
}

bool MeshFolder::Exists(const char* name) const { return name != nullptr && !resolve(name).empty(); }

Assimp::IOStream* MeshFolder::Open(const char* name, const char* mode) {
  if (name == nullptr || mode == nullptr || mode[0] != 'r' ||
      std::string(mode).find('+') != std::string::npos) {
    return nullptr;
  }
  const fs::path file = resolve(name);
  std::error_code error;
  if (file.empty() || fs::file_size(file, error) > kMaxMeshFileBytes || error) return nullptr;
  return DefaultIOSystem::Open(file.c_str(), "rb");
}

}  // namespace sextant
