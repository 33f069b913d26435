// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/object_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "offline/cli/object_id.h"
#include "offline/synthesize/synthesize.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

bool is_mesh(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  static const std::set<std::string> kMeshes{".ply", ".obj", ".stl", ".gltf", ".glb", ".dae"};
  return kMeshes.count(extension) > 0;
}

}  // namespace

LoadedObject load_object_file(const std::string& text, const MeshArguments& for_all) {
  MeshArguments arguments = for_all;
  std::filesystem::path file = text;
  std::error_code error;
  const std::size_t at = text.rfind('@');
  if (at != std::string::npos && !std::filesystem::exists(file, error)) {
    file = text.substr(0, at);
    const std::string how = text.substr(at + 1);
    const std::size_t comma = how.find(',');
    arguments.units = how.substr(0, comma);
    if (comma != std::string::npos) arguments.up = how.substr(comma + 1);
    static const std::set<std::string> kUnits{"m", "cm", "mm", "in"};
    static const std::set<std::string> kUps{"", "x", "y", "z", "-x", "-y", "-z"};
    if (kUnits.count(arguments.units) == 0 || kUps.count(arguments.up) == 0) {
      throw UsageError(text + " does not end in @UNITS or @UNITS,UP",
                       "for example can.glb@m,y or mug.stl@mm,z");
    }
  }
  if (is_mesh(file)) return {load_standing_object(file, arguments.options()), object_id_in_name(file)};
  const ObjectModel model = read_model(file);
  return {standing_object_of(model), model.object_id};
}

}  // namespace sextant
