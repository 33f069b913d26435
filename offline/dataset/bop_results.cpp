// SPDX-License-Identifier: Apache-2.0
#include "offline/dataset/bop_results.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "hal/image/file_bytes.h"
#include "hal/playback/rotation_input.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxResultBytes = std::size_t{256} << 20;
constexpr std::string_view kSpaces = " \t";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

template <typename T>
std::optional<T> parsed(std::string_view text) {
  text = trimmed(text);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(value)) return std::nullopt;
  }
  return value;
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators, bool merge) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find_first_of(separators);
    const std::string_view part = text.substr(0, end);
    if (!merge || !part.empty()) parts.push_back(part);
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

class Line {
 public:
  Line(std::string_view text, std::string where)
      : fields_(split(text, ",", false)), where_(std::move(where)) {
    if (fields_.size() != 7) refuse("must have 7 fields " + std::string(kBopResultsHeader));
  }
  int integer(std::size_t field, const char* name) const {
    const auto value = parsed<int>(fields_[field]);
    if (!value || *value < 0) refuse(std::string(name) + " must be a whole number");
    return *value;
  }
  double number(std::size_t field, const char* name) const {
    const auto value = parsed<double>(fields_[field]);
    if (!value) refuse(std::string(name) + " must be a number");
    return *value;
  }
  std::vector<double> numbers(std::size_t field, const char* name, std::size_t count) const {
    std::vector<double> values;
    for (const std::string_view part : split(trimmed(fields_[field]), kSpaces, true)) {
      const auto value = parsed<double>(part);
      if (value) values.push_back(*value);
    }
    if (values.size() != count) refuse(fmt::format("{} must be {} numbers with spaces between", name, count));
    return values;
  }
  [[noreturn]] void refuse(const std::string& what) const { throw InputError(where_, what); }

 private:
  std::vector<std::string_view> fields_;
  std::string where_;
};

BopResult parse_line(const Line& line) {
  BopResult result;
  result.scene_id = line.integer(0, "scene_id");
  result.image_id = line.integer(1, "im_id");
  result.object_id = line.integer(2, "obj_id");
  result.score = line.number(3, "score");
  const auto rotation = rotation_from_rounded(line.numbers(4, "R", 9));
  if (!rotation) line.refuse("R is not a rotation matrix");
  const std::vector<double> t = line.numbers(5, "t", 3);
  result.camera_from_mesh.linear() = *rotation;
  result.camera_from_mesh.translation() = Eigen::Vector3d(t[0], t[1], t[2]) / 1000.0;
  result.seconds = line.number(6, "time");
  return result;
}

}  // namespace

std::string format_bop_result(const BopResult& result) {
  const Eigen::Matrix3d r = result.camera_from_mesh.linear();
  const Eigen::Vector3d t = result.camera_from_mesh.translation() * 1000.0;
  return fmt::format("{},{},{},{},{} {} {} {} {} {} {} {} {},{} {} {},{}", result.scene_id, result.image_id,
                     result.object_id, result.score, r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2),
                     r(2, 0), r(2, 1), r(2, 2), t.x(), t.y(), t.z(), result.seconds);
}

std::vector<BopResult> bop_results_of(const FrameResult& result) {
  std::vector<BopResult> rows;
  for (const PoseEstimate& estimate : result.estimates) {
    rows.push_back({static_cast<int>(result.scene_id), static_cast<int>(result.image_id), estimate.object_id,
                    estimate.score, estimate.camera_from_object, result.seconds.total});
  }
  return rows;
}

void write_bop_results(const std::filesystem::path& file, const std::vector<BopResult>& results) {
  std::string text = std::string(kBopResultsHeader) + "\n";
  for (const BopResult& result : results) text += format_bop_result(result) + "\n";
  write_file_bytes(file, std::as_bytes(std::span(text)));
}

std::vector<BopResult> read_bop_results(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = read_file_bytes(file, kMaxResultBytes);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<BopResult> results;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty() || (number == 1 && line == kBopResultsHeader)) continue;
    results.push_back(parse_line(Line(line, fmt::format("{}:{}", file.string(), number))));
  }
  return results;
}

}  // namespace sextant
