// SPDX-License-Identifier: Apache-2.0
#include "offline/report/model_sheet/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "offline/report/model_sheet/shaded_mesh.h"
#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr double kRadians = std::numbers::pi / 180;
/// Panels are drawn this much larger and then reduced: smooth edges without seams between triangles.
constexpr int kOversampling = 2;
constexpr int kCaptionPx = 20;
constexpr int kGapPx = 8;
constexpr int kLegendPx = 44;
const cv::Scalar kPaper(24, 26, 30);
const cv::Scalar kPanel(40, 43, 48);
const cv::Scalar kInk(225, 225, 225);

cv::Scalar colour_of_kind(int kind) {
  cv::Mat3b pixel(1, 1, cv::Vec3b(static_cast<std::uint8_t>(kind * 180 / kFeatureKinds), 220, 255));
  cv::cvtColor(pixel, pixel, cv::COLOR_HSV2RGB);
  const cv::Vec3b c = pixel(0, 0);
  return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

/// share 0 (near) .. 1 (far).
cv::Scalar colour_of_depth(double share) {
  cv::Mat1b value(1, 1, static_cast<std::uint8_t>(std::lround(255 * std::clamp(1 - share, 0.0, 1.0))));
  cv::Mat3b colour;
  cv::applyColorMap(value, colour, cv::COLORMAP_TURBO);
  const cv::Vec3b bgr = colour(0, 0);
  return {static_cast<double>(bgr[2]), static_cast<double>(bgr[1]), static_cast<double>(bgr[0])};
}

void write(cv::Mat& image, const std::string& text, cv::Point at, double size = 0.38) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kInk, 1, cv::LINE_AA);
}

/// The view of one bin: a camera that looks straight at the object's centre from a common distance.
class BinView {
 public:
  BinView(const ObjectModel& model, const ViewpointBin& bin, int panel_px) : model_(model), bin_(bin) {
    const int side = panel_px * kOversampling;
    pose_.z = std::max(0.8, 4 * model.bounding_radius_m);
    camera_ = {side, side, 0.44 * side * pose_.z / model.bounding_radius_m, (side - 1) / 2.0,
               (side - 1) / 2.0};
    pose_.x = camera_.cx;
    pose_.y = camera_.cy;
    const auto centre = [&](std::size_t i) { return (bin.box.lo_deg[i] + bin.box.hi_deg[i]) * kRadians / 2; };
    pose_.rx = centre(0);
    pose_.ry = centre(1);
    pose_.rz = centre(2);
    background_ = cv::Mat(side, side, CV_8UC3, kPanel);
    draw_shaded_mesh(model.mesh, camera_, transform_from_pose(camera_, pose_), background_);
  }

  /// Strokes: position by eqs. 3.3 and 3.4, direction and colour by kind.
  cv::Mat visual_panel() const {
    cv::Mat panel = background_.clone();
    const double half = 0.022 * panel.cols;
    for (const VisualPart& part : bin_.visual) {
      const double x = pose_.x + camera_.focal / pose_.z * at_pose(part.u);
      const double y = pose_.y + camera_.focal / pose_.z * at_pose(part.v);
      if (!is_on(panel, x, y)) continue;
      const double angle = part.kind * std::numbers::pi / kFeatureKinds;
      const double dx = half * std::cos(angle);
      const double dy = half * std::sin(angle);
      cv::line(panel, pixel(x - dx, y - dy), pixel(x + dx, y + dy), colour_of_kind(part.kind),
               2 * kOversampling - 1, cv::LINE_AA);
    }
    return reduced(panel);
  }

  /// Dots: position by eq. 3.6, colour by the expected depth relative to the centre's (eq. 3.7).
  cv::Mat depth_panel() const {
    cv::Mat panel = background_.clone();
    for (const DepthPart& part : bin_.depth) {
      const double x = pose_.x + camera_.focal / pose_.z * part.px;
      const double y = pose_.y + camera_.focal / pose_.z * part.py;
      if (!is_on(panel, x, y)) continue;
      const double share = 0.5 + 0.5 * at_pose(part.d) / model_.bounding_radius_m;
      const int radius = std::max(2, panel.cols / 110);
      cv::circle(panel, pixel(x, y), radius + 1, cv::Scalar::all(0), cv::FILLED, cv::LINE_AA);
      cv::circle(panel, pixel(x, y), radius, colour_of_depth(share), cv::FILLED, cv::LINE_AA);
    }
    return reduced(panel);
  }

 private:
  double at_pose(const std::array<float, 4>& form) const {
    return form[0] + form[1] * pose_.rx + form[2] * pose_.ry + form[3] * pose_.rz;
  }
  static bool is_on(const cv::Mat& panel, double x, double y) {
    return x > -panel.cols && x < 2 * panel.cols && y > -panel.rows && y < 2 * panel.rows;
  }
  static cv::Point pixel(double x, double y) {
    return {static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))};
  }
  static cv::Mat reduced(const cv::Mat& panel) {
    cv::Mat small;
    cv::resize(panel, small, panel.size() / kOversampling, 0, 0, cv::INTER_AREA);
    return small;
  }

  const ObjectModel& model_;
  const ViewpointBin& bin_;
  PinholeCamera camera_;
  Pose6 pose_;
  cv::Mat background_;
};

std::string caption(const ViewpointBin& bin, std::size_t index) {
  const auto range = [&](std::size_t i) {
    return fmt::format("{}..{}", bin.box.lo_deg[i], bin.box.hi_deg[i]);
  };
  return fmt::format("#{}  rx {}  ry {}  rz {} deg  {}+{} parts", index, range(0), range(1), range(2),
                     bin.visual.size(), bin.depth.size());
}

void draw_legend(const ObjectModel& model, std::size_t shown, cv::Mat strip) {
  write(strip,
        fmt::format("{}: {} of {} bins, each seen at its centre", model.name, shown, model.bins.size()),
        {kGapPx, 15}, 0.42);
  int x = kGapPx;
  const int y = 33;
  write(strip, "edge along", {x, y + 4});
  x += 92;
  for (int kind = 0; kind < kFeatureKinds; ++kind) {
    const double angle = kind * std::numbers::pi / kFeatureKinds;
    const cv::Point half(static_cast<int>(std::lround(7 * std::cos(angle))),
                         static_cast<int>(std::lround(7 * std::sin(angle))));
    cv::line(strip, cv::Point(x, y) - half, cv::Point(x, y) + half, colour_of_kind(kind), 2, cv::LINE_AA);
    x += 20;
  }
  x += 10;
  const double reach_mm = model.bounding_radius_m * 1000;
  const std::string near = fmt::format("depth {:.0f} mm", -reach_mm);
  write(strip, near, {x, y + 4});
  x += 8 + cv::getTextSize(near, cv::FONT_HERSHEY_SIMPLEX, 0.38, 1, nullptr).width;
  constexpr int kBarPx = 96;
  for (int i = 0; i < kBarPx; ++i) {
    cv::line(strip, {x + i, y - 5}, {x + i, y + 5}, colour_of_depth(i / (kBarPx - 1.0)), 1);
  }
  write(strip, fmt::format("+{:.0f} mm from the centre's", reach_mm), {x + kBarPx + 8, y + 4});
}

}  // namespace

std::vector<std::size_t> bins_of_sheet(std::size_t bin_count, std::size_t max_bins) {
  const std::size_t shown = std::min(bin_count, max_bins);
  std::vector<std::size_t> bins(shown);
  for (std::size_t i = 0; i < shown; ++i) {
    // One bin of each of `shown` equal stretches, at golden-ratio places, so that the pick does not fall into
    // step with the order of the bins (every second elevation, say).
    const std::size_t from = i * bin_count / shown;
    const std::size_t to = (i + 1) * bin_count / shown;
    const double place = std::fmod(static_cast<double>(i) * std::numbers::phi, 1.0);
    bins[i] = from + static_cast<std::size_t>(place * static_cast<double>(to - from));
  }
  return bins;
}

cv::Mat draw_contact_sheet(const ObjectModel& model, const ContactSheetOptions& options) {
  const int panel = std::clamp(options.panel_px, 64, 512);
  const std::vector<std::size_t> bins =
      bins_of_sheet(model.bins.size(), std::clamp<std::size_t>(options.max_bins, 1, kMaxSheetBins));
  const cv::Size tile(2 * panel + kGapPx, kCaptionPx + panel + kGapPx);
  const int count = static_cast<int>(bins.size());
  // About as wide as high, and wide enough for the legend.
  const double square = std::sqrt(count * static_cast<double>(tile.height) / tile.width);
  const int columns = std::clamp(static_cast<int>(std::ceil(square)), 1, std::max(1, count));
  const int rows = (count + columns - 1) / columns;
  const int width = std::max(columns * tile.width + kGapPx, 560);
  cv::Mat sheet(kLegendPx + rows * tile.height, width, CV_8UC3, kPaper);
  draw_legend(model, bins.size(), sheet.rowRange(0, kLegendPx));
  for (int i = 0; i < count; ++i) {
    const std::size_t index = bins[static_cast<std::size_t>(i)];
    const BinView view(model, model.bins[index], panel);
    const cv::Point corner(kGapPx + i % columns * tile.width, kLegendPx + i / columns * tile.height);
    write(sheet, caption(model.bins[index], index), corner + cv::Point(0, 14));
    const cv::Rect left(corner.x, corner.y + kCaptionPx, panel, panel);
    view.visual_panel().copyTo(sheet(left));
    view.depth_panel().copyTo(sheet(left + cv::Point(panel, 0)));
  }
  return sheet;
}

}  // namespace sextant
