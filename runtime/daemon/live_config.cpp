// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/live_config.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "hal/live/stream_options.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

bool is_format(const std::string& text) { return text == "auto" || format_named(text).has_value(); }

std::vector<ConfigField> stream_fields(LiveConfig::Stream& stream, const std::string& section, bool depth) {
  return {
      {.section = section,
       .key = "device",
       .target = &stream.device,
       .text = "Which device: an id that `sextant camera list` prints, such as a by-id name, serial:1234, "
               "bus:usb-0000:00:14.0-1, or a path (/dev/video0 may change with the order of plugging)."},
      {.section = section,
       .key = "format",
       .target = &stream.format,
       .text = depth ? "auto, Z16, Y16, Y10, Y12, Y10B or Y11B. auto takes the first that the device offers."
                     : "auto, YUYV, UYVY, NV12, RGB3, BGR3, MJPG or GREY. auto takes the first that the device "
                       "offers in this size and rate.",
       .accepts = is_format,
       .accepted_form = "auto or the name of a format"},
      {.section = section,
       .key = "width",
       .target = &stream.width,
       .text = "Of the images; the device must offer exactly this size.",
       .unit = "pixels",
       .lowest = 16,
       .highest = 16384},
      {.section = section,
       .key = "height",
       .target = &stream.height,
       .text = "Likewise.",
       .unit = "pixels",
       .lowest = 16,
       .highest = 16384},
      {.section = section,
       .key = "rate_hz",
       .target = &stream.rate_hz,
       .text = "Images per second; 0 leaves it to the device.",
       .unit = "Hz",
       .lowest = 0,
       .highest = 1000},
      {.section = section,
       .key = "controls",
       .target = &stream.controls,
       .text = "Set before streaming, in this order, each \"name=value\": [\"auto_exposure=Manual Mode\", "
               "\"exposure_time_absolute=100\", \"gain=16\", \"power_line_frequency=50 Hz\"]. Automatics first."},
      {.section = section,
       .key = "camera",
       .target = &stream.camera,
       .text = depth ? "Calibration of the depth camera and depth_scale_mm, the millimetres of one depth unit; a "
                       "file as for `sextant detect --camera`. Not needed where registered is true: the colour "
                       "camera's file holds for both then."
                     : "Calibration of the colour camera: a file as for `sextant detect --camera`."},
  };
}

void check_stream(const LiveConfig::Stream& stream, const LiveConfig& config, bool depth, const std::string& where) {
  const char* section = depth ? "depth" : "colour";
  if (stream.device.empty())
    throw InputError(where, fmt::format("{}.device is missing", section), "`sextant camera list` shows what there is");
  if (stream.camera.empty() && !(depth && config.depth_registered))
    throw InputError(where, fmt::format("{}.camera is missing", section),
                     "give the calibration: a file as for `sextant detect --camera`");
  if (stream.format == "auto") return;
  const PixelFormatInfo& info = info_of(*format_named(stream.format));
  if (depth ? !info.is_depth : !info.is_colour)
    throw InputError(where, fmt::format("{}.format {} holds no {}", section, stream.format, section),
                     "write auto to let the device choose");
}

}  // namespace

std::vector<ConfigSection> live_sections() {
  return {
      {"colour", "The colour camera. Only for source.kind: v4l2 and libcamera."},
      {"depth", "The depth camera, always by V4L2. Only for source.kind: v4l2 and libcamera."},
      {"live", "How live streams become frames. Only for source.kind: v4l2 and libcamera."},
  };
}

std::vector<ConfigField> live_fields(LiveConfig& c) {
  std::vector<ConfigField> fields = stream_fields(c.colour, "colour", false);
  for (ConfigField& field : stream_fields(c.depth, "depth", true)) fields.push_back(std::move(field));
  const std::vector<ConfigField> rest{
      {.section = "depth",
       .key = "encoding",
       .target = &c.depth_encoding,
       .text = "linear: value * depth_scale_mm of the camera's file; kinect_disparity: the first Kinect's raw "
               "stream (Y10B, Y11B).",
       .choices = {"linear", "kinect_disparity"}},
      {.section = "depth",
       .key = "nearest_m",
       .target = &c.depth_nearest_m,
       .text = "Nearer depth is taken for missing.",
       .unit = "m",
       .lowest = 0,
       .highest = 100},
      {.section = "depth",
       .key = "farthest_m",
       .target = &c.depth_farthest_m,
       .text = "Farther depth is taken for missing.",
       .unit = "m",
       .lowest = 0,
       .highest = 100},
      {.section = "depth",
       .key = "registered",
       .target = &c.depth_registered,
       .text = "true: the device has moved depth into the colour camera already (same size, same calibration)."},
      {.section = "depth",
       .key = "colour_from_depth",
       .target = &c.colour_from_depth,
       .text = "Where the depth camera stands in the colour camera's frame: [x, y, z, qx, qy, qz, qw], metres "
               "and a unit quaternion. [] where they are in one place."},
      {.section = "live",
       .key = "pair_tolerance_ms",
       .target = &c.pair_tolerance_ms,
       .text = "Colour and depth images further apart in time than this are no pair (half a period is right).",
       .unit = "ms",
       .lowest = 0,
       .highest = 1000},
      {.section = "live",
       .key = "shared_sequence",
       .target = &c.shared_sequence,
       .text = "true: both streams count the same frames in hardware; pair equal numbers instead of times."},
      {.section = "live",
       .key = "watchdog_ms",
       .target = &c.watchdog_ms,
       .text = "A stream without a good image for so long is opened anew.",
       .unit = "ms",
       .lowest = 50,
       .highest = 600000},
      {.section = "live",
       .key = "buffers",
       .target = &c.buffers,
       .text = "Buffers of each stream.",
       .lowest = 2,
       .highest = 32},
  };
  fields.insert(fields.end(), rest.begin(), rest.end());
  return fields;
}

bool is_live(const std::string& source_kind) { return source_kind == "v4l2" || source_kind == "libcamera"; }

void check_live_config(const LiveConfig& config, const std::string& source_kind, const std::string& where) {
  if (!is_live(source_kind)) return;
  check_stream(config.colour, config, false, where);
  check_stream(config.depth, config, true, where);
  if (config.colour.device == config.depth.device && source_kind == "v4l2")
    throw InputError(where, "colour.device and depth.device are the same", "give each its own node (id#1)");
  if (config.depth_nearest_m >= config.depth_farthest_m)
    throw InputError(where, "depth.nearest_m is not below depth.farthest_m", "swap or widen them");
  if (config.depth_registered && !config.colour_from_depth.empty())
    throw InputError(where, "depth.colour_from_depth is given, but depth.registered is true", "remove one");
  parse_rigid_transform(config.colour_from_depth, where);
}

}  // namespace sextant
