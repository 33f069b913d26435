// SPDX-License-Identifier: Apache-2.0
#include "hal/playback/recording_format.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string_view>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "hal/playback/json_file.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestLine = 16384;
constexpr std::size_t kLongestName = 200;

std::int64_t count_ns(const auto& time) { return time.time_since_epoch().count(); }

/// A whole number of any size; JsonView's numbers are doubles.
std::int64_t whole_number(const JsonView& view) {
  if (!view.value().is_number_integer()) view.refuse("must be a whole number");
  return view.value().get<std::int64_t>();
}

std::uint64_t count_in(const JsonView& object, const char* key) {
  const std::int64_t n = whole_number(object.at(key));
  if (n < 0) object.refuse(std::string(key) + " is negative");
  return static_cast<std::uint64_t>(n);
}

RecordedFrame frame_of(const JsonView& line) {
  RecordedFrame r;
  r.image_id = line.at("image").integer(0, 999'999'999);
  r.depth_scale_mm = line.at("depth_scale_mm").number(1e-6, 1e3);
  RgbdFrame& f = r.frame;
  f.sequence = whole_number(line.at("sequence"));
  f.captured_at = CaptureTime(std::chrono::nanoseconds(whole_number(line.at("captured_at_ns"))));
  f.captured_monotonic =
      MonotonicTime(std::chrono::nanoseconds(whole_number(line.at("captured_monotonic_ns"))));
  const JsonView name = line.at("frame_id");
  if (!name.value().is_string() || name.value().get_ref<const std::string&>().size() > kLongestName) {
    name.refuse("must be a short text");
  }
  f.frame_id = name.value().get<std::string>();
  const JsonView camera = line.at("camera");
  CameraModel& c = f.camera;
  c.width = camera.at("width").integer(16, kMaxImageSide);
  c.height = camera.at("height").integer(16, kMaxImageSide);
  c.fx = camera.at("fx").number(1e-3, 1e7);
  c.fy = camera.at("fy").number(1e-3, 1e7);
  c.cx = camera.at("cx").number(-1e6, 1e6);
  c.cy = camera.at("cy").number(-1e6, 1e6);
  const std::vector<double> distortion = camera.at("distortion").numbers(c.distortion.size());
  std::copy(distortion.begin(), distortion.end(), c.distortion.begin());
  c.check(camera.where());
  if (const auto table = line.find("table")) {
    constexpr double kPi = std::numbers::pi;
    f.table = TableGeometry::from_pitch_roll(table->at("pitch_rad").number(-kPi, kPi),
                                             table->at("roll_rad").number(-kPi, kPi),
                                             table->at("height_m").number(1e-3, 100));
    if (const auto u = table->find("uncertainty")) {
      f.table_uncertainty = TableUncertainty{
          u->at("height_m").number(0, 100), u->at("pitch_rad").number(0, 10), u->at("roll_rad").number(0, 10),
          u->at("tilt_rad").number(0, 10), u->at("surface_m").number(0, 100)};
    }
  }
  return r;
}

/// One parsed line into the list.
void add_line(const nlohmann::json& json, const std::string& where, bool first, RecordingList& list,
              bool& ended) {
  const JsonView line(json, where);
  if (first) {
    const int version = line.at("sextant_recording").integer(0, 1'000'000);
    if (version != kRecordingVersion) {
      line.refuse(
          fmt::format("is version {} of the format, this program reads {}", version, kRecordingVersion));
    }
    return;
  }
  if (ended) line.refuse("comes after the end");
  const auto end = line.find("end");
  if (!end) {
    list.frames.push_back(frame_of(line));
    return;
  }
  ended = true;
  const std::uint64_t lost =
      count_in(*end, "lost_slow") + count_in(*end, "lost_failed") + count_in(*end, "lost_source");
  if (lost > 0) list.remarks.push_back(fmt::format("{} frames were lost while it was recorded", lost));
}

}  // namespace

std::string recording_header() { return Json{{"sextant_recording", kRecordingVersion}}.dump() + "\n"; }

std::string line_of(const RecordedFrame& r) {
  const RgbdFrame& f = r.frame;
  const CameraModel& c = f.camera;
  Json line = {{"image", r.image_id},
               {"sequence", f.sequence},
               {"captured_at_ns", count_ns(f.captured_at)},
               {"captured_monotonic_ns", count_ns(f.captured_monotonic)},
               {"frame_id", f.frame_id.substr(0, kLongestName)},
               {"camera",
                {{"width", c.width},
                 {"height", c.height},
                 {"fx", c.fx},
                 {"fy", c.fy},
                 {"cx", c.cx},
                 {"cy", c.cy},
                 {"distortion", c.distortion}}},
               {"depth_scale_mm", r.depth_scale_mm}};
  if (f.table) {
    Json table = {{"pitch_rad", f.table->pitch_rad()},
                  {"roll_rad", f.table->roll_rad()},
                  {"height_m", f.table->camera_height_m}};
    if (f.table_uncertainty) {
      const TableUncertainty& u = *f.table_uncertainty;
      table["uncertainty"] = {{"height_m", u.height_m},
                              {"pitch_rad", u.pitch_rad},
                              {"roll_rad", u.roll_rad},
                              {"tilt_rad", u.tilt_rad},
                              {"surface_m", u.surface_m}};
    }
    line["table"] = table;
  }
  // Names may come from the wire: whatever is no UTF-8 is replaced.
  return line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string line_of(const RecordingEnd& end) {
  return Json{{"end",
               {{"recorded", end.recorded},
                {"lost_slow", end.lost_slow},
                {"lost_failed", end.lost_failed},
                {"lost_source", end.lost_source}}}}
             .dump() +
         "\n";
}

RecordingList read_recording_list(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = read_file_bytes(file, kMaxJsonBytes * 4);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  RecordingList list;
  bool ended = false;
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    ++number;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    if (end == std::string_view::npos) {
      list.remarks.push_back(fmt::format("{} is cut off and ignored", where));
      break;
    }
    if (end - at > kLongestLine) throw InputError(where, "is absurdly long");
    const nlohmann::json json = nlohmann::json::parse(text.substr(at, end - at), nullptr, false);
    if (json.is_discarded()) throw InputError(where, "is not valid JSON", "delete this line");
    add_line(json, where, number == 1, list, ended);
    at = end + 1;
  }
  if (number == 0) throw InputError(file.string(), "is empty", "nothing was recorded");
  if (!ended) list.remarks.push_back("the recording was interrupted before its end");
  return list;
}

}  // namespace sextant
