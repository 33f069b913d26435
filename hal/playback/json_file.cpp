// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/json_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hal/image/file_bytes.h"
#include "runtime/base/error.h"

namespace sextant {

nlohmann::json read_json_file(const std::filesystem::path& file) {
  const std::string where = file.string();
  const std::vector<std::byte> bytes = read_file_bytes(file, kMaxJsonBytes);
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  std::size_t values = 0;
  const auto guard = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    if (depth > kMaxJsonDepth)
      throw InputError(where, "is nested deeper than " + std::to_string(kMaxJsonDepth));
    if (++values > kMaxJsonValues) {
      throw InputError(where, "holds more than " + std::to_string(kMaxJsonValues) + " values");
    }
    return true;
  };
  try {
    return nlohmann::json::parse(text, text + bytes.size(), guard);
  } catch (const nlohmann::json::exception& error) {
    // The library's messages begin with "[json.exception.parse_error.101] ".
    std::string reason = error.what();
    if (const std::size_t end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
    std::replace_if(
        reason.begin(), reason.end(), [](unsigned char c) { return c < 32 || c > 126; }, '?');
    throw InputError(where, "is not valid JSON (" + reason.substr(0, 200) + ")",
                     "correct it or get it again");
  }
}

JsonView JsonView::at(const std::string& key, const std::string& label) const {
  std::optional<JsonView> found = find(key, label);
  if (!found) refuse("\"" + (label.empty() ? key : label) + "\" is missing");
  return *found;
}

std::optional<JsonView> JsonView::find(const std::string& key, const std::string& label) const {
  if (!value_->is_object()) refuse("must be an object {...}");
  const auto it = value_->find(key);
  if (it == value_->end()) return std::nullopt;
  return JsonView(*it, where_ + ": " + (label.empty() ? key : label));
}

std::vector<int> JsonView::number_keys() const {
  if (!value_->is_object()) refuse("must be an object {...}");
  std::vector<int> keys;
  for (const auto& item : value_->items()) {
    const std::string& key = item.key();
    int number = -1;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
    // The canonical form only: "01" beside "1" would be two images of one number.
    if (error != std::errc() || number < 0 || number > 999'999'999 || std::to_string(number) != key) {
      refuse("the key \"" + key.substr(0, 40) + "\" should be a whole number");
    }
    keys.push_back(number);
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<JsonView> JsonView::elements() const {
  if (!value_->is_array()) refuse("must be an array [...]");
  std::vector<JsonView> views;
  views.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i) {
    views.emplace_back((*value_)[i], where_ + "[" + std::to_string(i) + "]");
  }
  return views;
}

double JsonView::number(double lo, double hi) const {
  if (!value_->is_number()) refuse("must be a number");
  const double number = value_->get<double>();
  if (!(std::isfinite(number) && number >= lo && number <= hi)) {
    refuse("must lie between " + nlohmann::json(lo).dump() + " and " + nlohmann::json(hi).dump());
  }
  return number;
}

int JsonView::integer(int lo, int hi) const {
  const double n = number(lo, hi);
  if (n != std::floor(n)) refuse("must be a whole number");
  return static_cast<int>(n);
}

std::vector<double> JsonView::numbers(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) refuse("must be " + std::to_string(count) + " numbers");
  std::vector<double> numbers;
  for (const JsonView& element : elements()) numbers.push_back(element.number(-1e9, 1e9));
  return numbers;
}

void JsonView::refuse(const std::string& what) const { throw InputError(where_, what); }

}  // namespace sextant
