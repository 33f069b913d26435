// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/source_arguments.h"

#include <fmt/format.h>

#include <cmath>

#include "runtime/base/error.h"

namespace sextant {

void SourceArguments::add_to(CLI::App& command) {
  std::string kinds;
  for (const std::string& kind : source_kinds()) kinds += (kinds.empty() ? "" : " | ") + kind;
  command.add_option("--source", source.kind, kinds)->capture_default_str();
  command.add_option("--dataset", source.playback.dataset, "playback: BOP, TUM RGB-D or recording folder");
  command.add_option("--split", source.playback.split, "playback: of a BOP data set or recording")
      ->capture_default_str();
  command.add_option("--scene", source.playback.scene, "playback: only this scene")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--image", source.playback.image, "playback: only this image number")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--rate-hz", source.playback.rate_hz, "playback: frames per second, 0: as fast as possible")
      ->capture_default_str();
  command.add_flag("--by-timestamps", by_timestamps, "playback: as it was captured");
  command.add_option("--speed", source.playback.speed, "with --by-timestamps: times as fast")
      ->capture_default_str();
  command.add_flag("--loop", source.playback.loop, "playback: begin again after the last frame");
  command.add_option("--color-device,--colour-device", source.colour.device,
                     "v4l2: an id of sextant camera list");
  command.add_option("--depth-device", source.depth.device, "v4l2: an id of sextant camera list");
  command.add_option("--color-format,--colour-format", source.colour.format, "v4l2: e.g. YUYV, MJPG")
      ->capture_default_str();
  command.add_option("--depth-format", source.depth.format, "v4l2: e.g. Z16, Y16")->capture_default_str();
  command.add_option("--rig", source.rig, "calibration of colour and depth camera (docs/cameras.md)");
  command.add_option("--domain", source.dds.domain, "dds: the domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  command.add_option("--color-topic,--colour-topic", source.dds.colour_topic,
                     "dds: e.g. camera/color/image_raw");
  command.add_option("--depth-topic", source.dds.depth_topic,
                     "dds: e.g. camera/aligned_depth_to_color/image_raw");
  command.add_flag("--stamp-on-arrival", source.dds.stamp_on_arrival,
                   "dds: do not believe the driver's stamps");
  command.add_flag("--no-rectify", no_rectify, "keep lens distortion and fx != fy");
  command.add_option("--max-age-ms", max_age_ms, "devices and dds: drop older frames as stale, 0: none")
      ->check(CLI::Range(0.0, 60000.0))
      ->capture_default_str();
  command.add_option("--frame-id", source.frame_id, "name of the camera's optical frame");
}

SourceOptions SourceArguments::options() const {
  SourceOptions out = source;
  if (out.kind == "playback" && out.playback.dataset.empty()) {
    throw UsageError("nothing to play", "give --dataset DIR, or another --source");
  }
  if (by_timestamps) out.playback.pace = PlaybackPace::kTimestamps;
  out.rectify = !no_rectify;
  out.max_age = std::chrono::milliseconds(std::llround(max_age_ms));
  return out;
}

std::string SourceArguments::describe() const {
  if (source.kind == "playback") return "playback of " + source.playback.dataset.string();
  if (source.kind == "dds")
    return fmt::format("dds {} + {}", source.dds.colour_topic, source.dds.depth_topic);
  return fmt::format("{} {} + {}", source.kind, source.colour.device, source.depth.device);
}

}  // namespace sextant
