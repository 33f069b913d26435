// SPDX-License-Identifier: Apache-2.0
// JSON files that are not trusted: bounded in bytes, values and depth; and typed reading of what is inside,
// so that every wrong type or missing key is refused with its file and path, e.g. "scene_camera.json: image
// 3: cam_K: must be 9 numbers".
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sextant {

inline constexpr std::size_t kMaxJsonBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxJsonValues = 4'000'000;  ///< numbers, strings, arrays, objects together
inline constexpr int kMaxJsonDepth = 16;

/// Parses a file. Throws InputError(file) where it is missing, too large, too deep or no JSON.
nlohmann::json read_json_file(const std::filesystem::path& file);

/// A value inside a JSON file together with the path that leads to it. The document must outlive it.
class JsonView {
 public:
  JsonView(const nlohmann::json& value, std::string where) : value_(&value), where_(std::move(where)) {}

  const std::string& where() const { return where_; }
  const nlohmann::json& value() const { return *value_; }

  /// Member of an object; throws InputError where this is no object or has no such key. `label` replaces the
  /// key in error messages ("image 3" for "3").
  JsonView at(const std::string& key, const std::string& label = "") const;
  /// Member of an object, nothing where it is missing; throws where this is no object.
  std::optional<JsonView> find(const std::string& key, const std::string& label = "") const;
  /// Keys of an object that are whole numbers 0..999999999, ascending; throws for any other key.
  std::vector<int> number_keys() const;
  /// Elements of an array; throws where this is none.
  std::vector<JsonView> elements() const;

  /// Finite number within [lo, hi].
  double number(double lo, double hi) const;
  /// Whole number within [lo, hi].
  int integer(int lo, int hi) const;
  /// Array of exactly `count` finite numbers, each of absolute value <= 1e9.
  std::vector<double> numbers(std::size_t count) const;

  /// Throws InputError(where(), what).
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  const nlohmann::json* value_;
  std::string where_;
};

}  // namespace sextant
