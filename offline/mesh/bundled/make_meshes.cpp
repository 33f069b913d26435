// SPDX-License-Identifier: Apache-2.0
// sextant-make-meshes FOLDER: writes the bundled meshes. For developers: data/meshes/ holds the result.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "offline/mesh/bundled/bundled_meshes.h"

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: sextant-make-meshes FOLDER\n", stderr);
    return 2;
  }
  for (const auto& [name, bytes] : sextant::bundled_mesh_files()) {
    const std::filesystem::path file = std::filesystem::path(arguments[1]) / name;
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
      std::fprintf(stderr, "%s: cannot be written; give a folder that exists\n", file.c_str());
      return 3;
    }
    std::printf("%s %zu bytes\n", file.c_str(), bytes.size());
  }
  return 0;
}
