// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/model_store.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {

std::vector<LoadedModel> load_models(const std::vector<std::filesystem::path>& files) {
  std::vector<LoadedModel> models;
  for (const std::filesystem::path& file : files) {
    ObjectModel model = read_model(file);
    const auto twin = std::find_if(models.begin(), models.end(),
                                   [&](const LoadedModel& other) { return other.model.name == model.name; });
    if (twin != models.end()) {
      throw InputError(file.string(),
                       "its object is called '" + model.name + "' as that of " + twin->file.string(),
                       "leave one out, or compile it under another name");
    }
    models.push_back({std::move(model), file});
  }
  return models;
}

std::filesystem::path allowed_model_file(const std::string& name,
                                         const std::vector<std::filesystem::path>& folders) {
  const std::filesystem::path asked(name);
  std::error_code error;
  for (const std::filesystem::path& folder : folders) {
    const bool bare = !asked.has_parent_path();
    const std::filesystem::path file = bare ? folder / asked : asked;
    if (!bare && std::filesystem::weakly_canonical(asked.parent_path(), error) !=
                     std::filesystem::weakly_canonical(folder, error))
      continue;
    if (std::filesystem::is_regular_file(file, error)) return file;
  }
  std::vector<std::string> names;
  for (const std::filesystem::path& folder : folders) names.push_back(folder.string());
  throw InputError(
      fmt::format("model_file '{}'", name), "there is no such model where models are taken from",
      names.empty() ? "models.files of the configuration names no folder"
                    : fmt::format("put it into {} and name it without a folder", fmt::join(names, " or ")));
}

}  // namespace sextant
