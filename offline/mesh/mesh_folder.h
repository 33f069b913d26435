// SPDX-License-Identifier: Apache-2.0
// The files that one mesh may open: those in its own folder and below, and nothing else. A mesh file is
// hostile until proven good, and it names other files (materials, buffers, textures).
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace sextant {

/// Largest file that belongs to a mesh, bytes.
inline constexpr std::uintmax_t kMaxMeshFileBytes = std::uintmax_t{512} << 20;

/// Resolves names against the mesh's folder; plugs into the importer.
class MeshFolder : public Assimp::DefaultIOSystem {
 public:
  explicit MeshFolder(const std::filesystem::path& mesh_file);

  /// Absolute path of a regular file inside the folder. Empty where there is none; such names are kept in
  /// mind, and names that lead out of the folder (absolute, "..", symbolic links) too: complain() tells.
  std::filesystem::path resolve(const std::string& name) const;
  /// Bytes of a file inside the folder. Throws InputError where it is missing, outside or too large.
  std::vector<std::byte> read(const std::string& name) const;

  /// Throws InputError if a name was refused, or if a missing one ends in `extension` (e.g. ".mtl").
  void complain(const std::string& extension) const;

  bool Exists(const char* name) const override;                         // NOLINT
  Assimp::IOStream* Open(const char* name, const char* mode) override;  // NOLINT

 private:
  std::string mesh_file_;         // for messages
  std::filesystem::path folder_;  // canonical
  mutable std::vector<std::string> missing_;
  mutable std::vector<std::string> refused_;
};

}  // namespace sextant
