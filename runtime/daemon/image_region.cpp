// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/image_region.h"

#include <fmt/format.h>

#include "runtime/base/error.h"

namespace sextant {

void check_region(const ImageRegion& region, int width, int height) {
  if (region == ImageRegion{}) return;
  const std::int64_t x = region[0], y = region[1];
  const std::int64_t right = std::min<std::int64_t>(x + region[2], width);
  const std::int64_t bottom = std::min<std::int64_t>(y + region[3], height);
  if (right - x < kSmallestRegion || bottom - y < kSmallestRegion) {
    throw InputError(
        "region",
        fmt::format("{} {} {} {} has less than {} x {} pixels inside the image of {} x {}", region[0],
                    region[1], region[2], region[3], kSmallestRegion, kSmallestRegion, width, height),
        "give x, y, width and height in pixels, or 0 0 0 0 for the whole image");
  }
}

RgbdFrame cut_to_region(const RgbdFrame& frame, const ImageRegion& region) {
  if (region == ImageRegion{}) return frame;
  check_region(region, frame.colour.cols, frame.colour.rows);
  // Within the image a region has coordinates of at most 16384: no overflow after this.
  const std::int64_t x = region[0], y = region[1];
  const std::int64_t right = std::min<std::int64_t>(x + region[2], frame.colour.cols);
  const std::int64_t bottom = std::min<std::int64_t>(y + region[3], frame.colour.rows);
  const cv::Rect part(static_cast<int>(x), static_cast<int>(y), static_cast<int>(right - x),
                      static_cast<int>(bottom - y));
  RgbdFrame cut = frame;
  cut.colour = frame.colour(part);
  cut.axial_depth_m = frame.axial_depth_m(part);
  cut.camera.width = part.width;
  cut.camera.height = part.height;
  cut.camera.cx -= part.x;
  cut.camera.cy -= part.y;
  return cut;
}

void move_boxes_back(FrameResult& result, const ImageRegion& region) {
  for (PoseEstimate& estimate : result.estimates) {
    estimate.bbox[0] += region[0];
    estimate.bbox[1] += region[1];
  }
}

}  // namespace sextant
