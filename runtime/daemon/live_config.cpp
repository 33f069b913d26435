// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/live_config.h"

#include <fmt/format.h>

#include <cmath>

#include "runtime/base/error.h"

namespace sextant {
namespace {

bool is_format(const std::string& text) { return text == "auto" || format_named(text).has_value(); }

std::vector<ConfigField> stream_fields(LiveConfig::Stream& stream, const std::string& section, bool depth) {
  return {
      {.section = section,
       .key = "device",
       .target = &stream.device,
       .text = "v4l2 and libcamera: which device, by an id that `sextant camera list` prints: a by-id name, "
               "serial:1234, bus:usb-0000:00:14.0-1, or a path (/dev/video0 may change with the order of "
               "plugging)."},
      {.section = section,
       .key = "topic",
       .target = &stream.topic,
       .text = depth
                   ? "dds: topic of the sensor_msgs/Image, e.g. camera/aligned_depth_to_color/image_raw; its "
                     "camera_info is expected beside it."
                   : "dds: topic of the sensor_msgs/Image, e.g. camera/color/image_raw; its camera_info is "
                     "expected beside it."},
      {.section = section,
       .key = "format",
       .target = &stream.format,
       .text =
           depth ? "auto, Z16, Y16, Y10, Y12, Y10B or Y11B. auto takes the first that the device offers. The "
                   "size is that of the rig file."
                 : "auto, YUYV, UYVY, NV12, RGB3, BGR3, MJPG or GREY. auto takes the first that the device "
                   "offers in this rate. The size is that of the rig file.",
       .accepts = is_format,
       .accepted_form = "auto or the name of a format"},
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
       .text = "Set before streaming, in this order (automatics first), each name=value, for example "
               "[\"auto_exposure=Manual Mode\", \"exposure_time_absolute=100\", \"power_line_frequency=50 "
               "Hz\"]."},
  };
}

void check_stream(const LiveConfig::Stream& stream, const std::string& kind, bool depth,
                  const std::string& where) {
  const char* section = depth ? "depth" : "colour";
  if (kind == "dds") {
    if (stream.topic.empty())
      throw InputError(where, fmt::format("{}.topic is missing", section),
                       "`sextant camera list` shows what there is");
    return;
  }
  if (stream.device.empty())
    throw InputError(where, fmt::format("{}.device is missing", section),
                     "`sextant camera list` shows what there is");
  if (stream.format == "auto") return;
  const PixelFormatInfo& info = info_of(*format_named(stream.format));
  if (depth ? !info.is_depth : !info.is_colour)
    throw InputError(where, fmt::format("{}.format {} holds no {}", section, stream.format, section),
                     "write auto to let the device choose");
}

StreamOptions stream_options(const LiveConfig::Stream& stream, const LiveConfig& config) {
  StreamOptions options;
  options.device = stream.device;
  options.format = stream.format;
  options.rate_hz = stream.rate_hz;
  options.controls = stream.controls;
  options.buffers = config.buffers;
  options.watchdog = std::chrono::milliseconds(std::llround(config.watchdog_ms));
  // A robot may start before its camera.
  options.wait_for_device = true;
  return options;
}

}  // namespace

std::vector<ConfigSection> live_sections() {
  return {
      {"colour", "The colour camera. Not for playback."},
      {"depth", "The depth camera; with kind libcamera it is a V4L2 device. Not for playback."},
      {"live", "How cameras are watched. Not for playback."},
  };
}

std::vector<ConfigField> live_fields(LiveConfig& c) {
  std::vector<ConfigField> fields = stream_fields(c.colour, "colour", false);
  for (ConfigField& field : stream_fields(c.depth, "depth", true)) fields.push_back(std::move(field));
  const std::vector<ConfigField> rest{
      {.section = "live",
       .key = "rig",
       .target = &c.rig,
       .text =
           "File with the calibration of both cameras, how they stand to each other and the unit of depth "
           "(docs/cameras.md). v4l2 and libcamera need it; with dds it replaces camera_info."},
      {.section = "live",
       .key = "rectify",
       .target = &c.rectify,
       .text = "Undo lens distortion and unequal focal lengths."},
      {.section = "live",
       .key = "width",
       .target = &c.width,
       .text =
           "Width of the frames that are made of the two images: scaled down, and rectified, when they are "
           "put together. Pixels in messages, regions and pictures are then those of these frames. 0: the "
           "colour image's.",
       .unit = "pixels",
       .lowest = 0,
       .highest = 4096},
      {.section = "live",
       .key = "max_age_ms",
       .target = &c.max_age_ms,
       .text = "Images and pairs older than this are dropped and counted as stale; 0: none is.",
       .unit = "ms",
       .lowest = 0,
       .highest = 60000},
      {.section = "live",
       .key = "watchdog_ms",
       .target = &c.watchdog_ms,
       .text = "v4l2 and libcamera: a stream without a good image for so long is opened anew.",
       .unit = "ms",
       .lowest = 50,
       .highest = 600000},
      {.section = "live",
       .key = "buffers",
       .target = &c.buffers,
       .text = "v4l2 and libcamera: buffers of each stream.",
       .lowest = 2,
       .highest = 32},
      {.section = "live",
       .key = "stamp_on_arrival",
       .target = &c.stamp_on_arrival,
       .text = "dds: true where the stamps of the driver's machine cannot be believed."},
  };
  fields.insert(fields.end(), rest.begin(), rest.end());
  return fields;
}

bool is_live(const std::string& source_kind) { return source_kind != "playback"; }

void check_live_config(const LiveConfig& config, const std::string& source_kind, const std::string& where) {
  if (!is_live(source_kind)) return;
  check_stream(config.colour, source_kind, false, where);
  check_stream(config.depth, source_kind, true, where);
  if (config.width != 0 && config.width < 64)
    throw InputError(where, "live.width is below 64", "use 64 to 4096, or 0 for the colour image's width");
  if (source_kind == "dds") return;
  if (config.rig.empty())
    throw InputError(where, "live.rig is missing",
                     "give the file with the cameras' calibration (docs/cameras.md)");
  if (config.colour.device == config.depth.device && source_kind == "v4l2")
    throw InputError(where, "colour.device and depth.device are the same", "give each its own node (id#1)");
}

void add_live_options(const LiveConfig& config, const std::string& source_kind, SourceOptions& options) {
  options.colour = stream_options(config.colour, config);
  options.depth = stream_options(config.depth, config);
  if (source_kind == "libcamera") options.depth_kind = "v4l2";
  options.dds.colour_topic = config.colour.topic;
  options.dds.depth_topic = config.depth.topic;
  options.dds.stamp_on_arrival = config.stamp_on_arrival;
  options.rectify = config.rectify;
  options.width = config.width;
  options.max_age = std::chrono::milliseconds(std::llround(config.max_age_ms));
}

}  // namespace sextant
