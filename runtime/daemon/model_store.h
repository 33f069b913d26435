// SPDX-License-Identifier: Apache-2.0
// The daemon's models with the files they came from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

struct LoadedModel {
  ObjectModel model;
  std::filesystem::path file;
};

/// Reads compiled models. Throws InputError where one cannot be read or two have the same name.
std::vector<LoadedModel> load_models(const std::vector<std::filesystem::path>& files);

/// The file that someone on the network asks for, who may name nothing outside of `folders`: a bare file name
/// is looked for in each of them, a path must lie directly in one. Throws InputError.
std::filesystem::path allowed_model_file(const std::string& name,
                                         const std::vector<std::filesystem::path>& folders);

}  // namespace sextant
