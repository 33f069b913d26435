// SPDX-License-Identifier: Apache-2.0
#include "hal/v4l2/v4l2_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "hal/live/stream_session.h"

namespace sextant {
namespace {

constexpr std::array<std::pair<int, int>, 8> kUsualSizes{
    {{320, 240}, {640, 360}, {640, 480}, {848, 480}, {1280, 720}, {1280, 960}, {1920, 1080}, {3840, 2160}}};
/// More than any device has; ends the loops of a driver that never says "no more".
constexpr std::uint32_t kMostEntries = 1000;

double rate_of(const v4l2_fract& interval) {
  return interval.numerator == 0 ? 0 : double{1} * interval.denominator / interval.numerator;
}

double fastest_rate(const V4l2Device& device, std::uint32_t fourcc, int width, int height) {
  double fastest = 0;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum entry{};
    entry.index = i;
    entry.pixel_format = fourcc;
    entry.width = static_cast<std::uint32_t>(width);
    entry.height = static_cast<std::uint32_t>(height);
    if (device.call(VIDIOC_ENUM_FRAMEINTERVALS, &entry) != 0) break;
    const bool discrete = entry.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    fastest = std::max(fastest, rate_of(discrete ? entry.discrete : entry.stepwise.min));
    if (!discrete) break;
  }
  return fastest;
}

/// The sizes of a format; of a range its ends and the usual ones that fit its steps.
std::vector<std::pair<int, int>> sizes_of(const V4l2Device& device, std::uint32_t fourcc) {
  std::vector<std::pair<int, int>> sizes;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum entry{};
    entry.index = i;
    entry.pixel_format = fourcc;
    if (device.call(VIDIOC_ENUM_FRAMESIZES, &entry) != 0) break;
    if (entry.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      sizes.emplace_back(entry.discrete.width, entry.discrete.height);
      continue;
    }
    const v4l2_frmsize_stepwise& range = entry.stepwise;
    const auto fits = [](int side, std::uint32_t lo, std::uint32_t hi, std::uint32_t step) {
      const auto s = static_cast<std::uint32_t>(side);
      return s >= lo && s <= hi && (s - lo) % std::max(step, 1U) == 0;
    };
    sizes.emplace_back(range.min_width, range.min_height);
    for (const auto& [w, h] : kUsualSizes) {
      if (fits(w, range.min_width, range.max_width, range.step_width) &&
          fits(h, range.min_height, range.max_height, range.step_height))
        sizes.emplace_back(w, h);
    }
    sizes.emplace_back(range.max_width, range.max_height);
    break;
  }
  return sizes;
}

/// The formats to try, the best first.
std::vector<PixelFormat> candidates(const std::vector<CameraMode>& modes, const StreamOptions& options,
                                    const std::string& where) {
  if (options.format != "auto") {
    const auto format = format_named(options.format);
    if (!format || info_of(*format).fourcc == 0)
      throw DeviceError(where, fmt::format("there is no format '{}'", options.format),
                        "use auto, or one of " + modes_text(modes));
    return {*format};
  }
  using enum PixelFormat;
  const std::vector<PixelFormat> order =
      options.depth ? std::vector{kZ16, kY16, kY12, kY10, kY11Bpack, kY10Bpack}
                    : std::vector{kYuyv, kUyvy, kNv12, kRgb24, kBgr24, kMjpeg, kGrey};
  std::vector<PixelFormat> fast;
  std::vector<PixelFormat> rest;
  for (const PixelFormat format : order) {
    const auto offers = [&](bool at_rate) {
      return std::any_of(modes.begin(), modes.end(), [&](const CameraMode& mode) {
        const bool same_size = mode.width == options.width && mode.height == options.height;
        return mode.format == format &&
               (!at_rate || (same_size && mode.max_rate_hz >= 0.9 * options.rate_hz));
      });
    };
    if (offers(true)) {
      fast.push_back(format);
    } else if (offers(false)) {
      rest.push_back(format);
    }
  }
  fast.insert(fast.end(), rest.begin(), rest.end());
  return fast;
}

/// Sets the format; what the driver made of it.
struct SetFormat {
  int error = 0;
  std::uint32_t fourcc = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t stride = 0;
  std::uint32_t field = 0;
  std::uint32_t planes = 1;
};

SetFormat set_format(const V4l2Device& device, PixelFormat format, const StreamOptions& options) {
  v4l2_format f{};
  f.type = device.capture_type();
  const bool multi = f.type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
  SetFormat result;
  if (multi) {
    v4l2_pix_format_mplane& pix = f.fmt.pix_mp;
    pix.width = static_cast<std::uint32_t>(options.width);
    pix.height = static_cast<std::uint32_t>(options.height);
    pix.pixelformat = info_of(format).fourcc;
    pix.field = V4L2_FIELD_NONE;
    pix.num_planes = 1;
    result.error = device.call(VIDIOC_S_FMT, &f);
    return {result.error, pix.pixelformat, pix.width, pix.height, pix.plane_fmt[0].bytesperline,
            pix.field,    pix.num_planes};
  }
  v4l2_pix_format& pix = f.fmt.pix;
  pix.width = static_cast<std::uint32_t>(options.width);
  pix.height = static_cast<std::uint32_t>(options.height);
  pix.pixelformat = info_of(format).fourcc;
  pix.field = V4L2_FIELD_NONE;
  result.error = device.call(VIDIOC_S_FMT, &f);
  return {result.error, pix.pixelformat, pix.width, pix.height, pix.bytesperline, pix.field, 1};
}

/// Sets and reads back the rate; 0 where the driver has none.
double set_rate(const V4l2Device& device, double rate_hz) {
  v4l2_streamparm parameters{};
  parameters.type = device.capture_type();
  if (device.call(VIDIOC_G_PARM, &parameters) != 0) return 0;
  v4l2_captureparm& capture = parameters.parm.capture;
  if (rate_hz > 0 && (capture.capability & V4L2_CAP_TIMEPERFRAME) != 0) {
    capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(rate_hz * 1000))};
    if (device.call(VIDIOC_S_PARM, &parameters) != 0) return 0;
  }
  return rate_of(capture.timeperframe);
}

void throw_unready(int error, const std::string& where) {
  if (error == EBUSY)
    throw DeviceUnready(where, "another program uses it", "close that program (fuser -v shows it)");
  if (error == ENODEV || error == ENXIO || error == EIO)
    throw DeviceUnready(where, "it failed: " + error_text(error), "unplug it and plug it in again");
}

bool is_interlaced(std::uint32_t field) { return field != V4L2_FIELD_NONE && field != V4L2_FIELD_ANY; }

}  // namespace

std::vector<CameraMode> list_modes(const V4l2Device& device) {
  std::vector<CameraMode> modes;
  for (std::uint32_t i = 0; i < kMostEntries; ++i) {
    v4l2_fmtdesc entry{};
    entry.index = i;
    entry.type = device.capture_type();
    if (device.call(VIDIOC_ENUM_FMT, &entry) != 0) break;
    const CameraMode format{fourcc_text(entry.pixelformat), format_of_fourcc(entry.pixelformat), 0, 0, 0};
    const auto sizes = sizes_of(device, entry.pixelformat);
    if (sizes.empty()) modes.push_back(format);
    for (const auto& [width, height] : sizes) {
      const bool seen = std::any_of(modes.begin(), modes.end(), [&](const CameraMode& mode) {
        return mode.fourcc == format.fourcc && mode.width == width && mode.height == height;
      });
      if (seen) continue;
      modes.push_back(format);
      modes.back().width = width;
      modes.back().height = height;
      modes.back().max_rate_hz = fastest_rate(device, entry.pixelformat, width, height);
    }
  }
  return modes;
}

std::string modes_text(const std::vector<CameraMode>& modes) {
  constexpr std::size_t kLongest = 900;
  std::string text;
  std::string last;
  for (const CameraMode& mode : modes) {
    if (!mode.format) continue;
    std::string entry = mode.fourcc == last ? ", " : (text.empty() ? "" : "; ") + mode.fourcc + " ";
    if (mode.width > 0) entry += fmt::format("{}x{}", mode.width, mode.height);
    if (mode.max_rate_hz > 0) entry += fmt::format(" at {:.4g} Hz", mode.max_rate_hz);
    if (text.size() + entry.size() > kLongest) return text + ", ...";
    text += entry;
    last = mode.fourcc;
  }
  return text.empty() ? "nothing that Sextant can decode" : text;
}

AgreedFormat agree_on_format(const V4l2Device& device, const StreamOptions& options,
                             const std::string& where) {
  const std::vector<CameraMode> modes = list_modes(device);
  const std::string asked = fmt::format(
      "{} {}x{}{}", options.format == "auto" ? (options.depth ? "depth" : "colour") : options.format,
      options.width, options.height,
      options.rate_hz > 0 ? fmt::format(" at {:.4g} Hz", options.rate_hz) : "");
  std::string instead;
  for (const PixelFormat format : candidates(modes, options, where)) {
    const SetFormat got = set_format(device, format, options);
    throw_unready(got.error, where);
    AgreedFormat agreed{format, static_cast<int>(got.width), static_cast<int>(got.height), got.stride, 0};
    if (info_of(format).bits_per_pixel == 0) agreed.stride = 0;
    if (got.error != 0 || got.fourcc != info_of(format).fourcc || agreed.width != options.width ||
        agreed.height != options.height || is_interlaced(got.field) || got.planes != 1) {
      instead = got.error != 0
                    ? error_text(got.error)
                    : fmt::format("it gives {}{} {}x{}", is_interlaced(got.field) ? "interlaced " : "",
                                  fourcc_text(got.fourcc), got.width, got.height);
      continue;
    }
    agreed.rate_hz = set_rate(device, options.rate_hz);
    if (options.rate_hz > 0 && agreed.rate_hz > 0 &&
        std::abs(agreed.rate_hz - options.rate_hz) > 0.1 * options.rate_hz) {
      instead = fmt::format("it gives {:.4g} Hz", agreed.rate_hz);
      continue;
    }
    // Some drivers leave the stride of a packed format out.
    if (info_of(format).bits_per_pixel != 0 && agreed.stride == 0)
      agreed.stride = least_stride(format, agreed.width);
    return agreed;
  }
  throw DeviceError(where,
                    fmt::format("it does not offer {}{}", asked, instead.empty() ? "" : " (" + instead + ")"),
                    "it offers " + modes_text(modes));
}

}  // namespace sextant
