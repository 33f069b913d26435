// SPDX-License-Identifier: Apache-2.0
#include "offline/report/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "offline/report/silhouette.h"

namespace sextant {
namespace {

constexpr int kWantedWidth = 1200;  ///< pixels of the picture, at least
constexpr int kMaxScale = 4;
constexpr double kTint = 0.16;  ///< share of the object's colour inside its outline
const cv::Scalar kInk(16, 18, 22);
const cv::Scalar kPaper(250, 250, 250);

/// Colours that stand out of wood, skin and walls. RGB.
cv::Scalar palette_colour(std::size_t index) {
  static const std::array<cv::Scalar, 7> kPalette{
      cv::Scalar(0, 200, 255),   cv::Scalar(255, 176, 0),  cv::Scalar(255, 70, 160), cv::Scalar(120, 230, 60),
      cv::Scalar(178, 120, 255), cv::Scalar(255, 236, 80), cv::Scalar(0, 235, 180)};
  return kPalette[index % kPalette.size()];
}

struct Canvas {
  cv::Mat image;
  int scale = 1;
  double unit = 1;                ///< pixels of the picture for one pixel of a 1280 wide one
  std::vector<cv::Rect> taken;    ///< by labels
  std::vector<cv::Rect> objects;  ///< boxes of what labels should not cover

  int px(double length) const { return std::max(1, static_cast<int>(std::lround(length * unit))); }
  double letter() const { return 0.62 * unit; }
};

void tint(Canvas& canvas, const cv::Mat& mask, const cv::Scalar& colour) {
  cv::Mat mixed;
  cv::addWeighted(canvas.image, 1 - kTint, cv::Mat(canvas.image.size(), CV_8UC3, colour), kTint, 0, mixed);
  mixed.copyTo(canvas.image, mask);
}

void draw_outline(Canvas& canvas, const cv::Mat& mask, const cv::Scalar& colour) {
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  cv::polylines(canvas.image, outlines, true, kInk, canvas.px(5), cv::LINE_AA);
  cv::polylines(canvas.image, outlines, true, colour, canvas.px(2.4), cv::LINE_AA);
}

/// Axes of the mesh frame, the farthest tip first so that the nearer ones lie on top.
void draw_axes(Canvas& canvas, const CameraModel& camera, const RigidTransform& camera_from_mesh,
               double length_m) {
  const std::array<cv::Scalar, 3> colours{cv::Scalar(235, 50, 40), cv::Scalar(60, 200, 60),
                                          cv::Scalar(60, 110, 255)};
  const auto origin = project_scaled(camera, camera_from_mesh.translation(), canvas.scale);
  if (!origin) return;
  std::array<std::size_t, 3> order{0, 1, 2};
  const auto depth_of_tip = [&](std::size_t axis) {
    return camera_from_mesh.linear()(2, static_cast<int>(axis));
  };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return depth_of_tip(a) > depth_of_tip(b); });
  for (const std::size_t axis : order) {
    const Eigen::Vector3d tip_m =
        camera_from_mesh.translation() + length_m * camera_from_mesh.linear().col(static_cast<int>(axis));
    const auto tip = project_scaled(camera, tip_m, canvas.scale);
    if (!tip) continue;
    const double pixels = std::max(1.0, std::hypot(tip->x - origin->x, tip->y - origin->y));
    const double head = std::min(0.35, canvas.px(11) / pixels);
    cv::arrowedLine(canvas.image, *origin, *tip, kInk, canvas.px(6), cv::LINE_AA, 0, head);
    cv::arrowedLine(canvas.image, *origin, *tip, colours[axis], canvas.px(3.2), cv::LINE_AA, 0, head);
  }
  cv::circle(canvas.image, *origin, canvas.px(4.5), kInk, cv::FILLED, cv::LINE_AA);
  cv::circle(canvas.image, *origin, canvas.px(3), kPaper, cv::FILLED, cv::LINE_AA);
}

/// Only what OpenCV's letters can draw.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32 || c > 126; }, '?');
  return text.size() > 48 ? text.substr(0, 45) + "..." : text;
}

struct Label {
  std::vector<std::string> lines;
  cv::Scalar colour;
};

cv::Size size_of(const Canvas& canvas, const Label& label) {
  int width = 0;
  int baseline = 0;
  for (const std::string& line : label.lines) {
    width = std::max(
        width,
        cv::getTextSize(line, cv::FONT_HERSHEY_DUPLEX, canvas.letter(), canvas.px(1), &baseline).width);
  }
  return {width + canvas.px(26), static_cast<int>(label.lines.size()) * canvas.px(25) + canvas.px(11)};
}

void draw_label(Canvas& canvas, const Label& label, const cv::Rect& box) {
  const cv::Rect inside = box & cv::Rect(0, 0, canvas.image.cols, canvas.image.rows);
  if (inside.empty()) return;
  cv::Mat area = canvas.image(inside);
  cv::addWeighted(area, 0.22, cv::Mat(area.size(), CV_8UC3, kInk), 0.78, 0, area);
  cv::rectangle(canvas.image, cv::Rect(box.x, box.y, canvas.px(6), box.height), label.colour, cv::FILLED);
  for (std::size_t i = 0; i < label.lines.size(); ++i) {
    const cv::Point at(box.x + canvas.px(16), box.y + canvas.px(24) + static_cast<int>(i) * canvas.px(25));
    cv::putText(canvas.image, label.lines[i], at, cv::FONT_HERSHEY_DUPLEX, canvas.letter(),
                i == 0 ? kPaper : cv::Scalar(205, 210, 218), canvas.px(1), cv::LINE_AA);
  }
  canvas.taken.push_back(box);
}

/// Where there is room beside the object: above, below, right, left, each also shifted along its side, best
/// without covering any object, at least without covering another label.
cv::Rect place_label(const Canvas& canvas, const cv::Size& size, const cv::Rect& object) {
  const cv::Rect picture(0, 0, canvas.image.cols, canvas.image.rows);
  const int gap = canvas.px(10);
  std::vector<cv::Rect> wishes;
  const auto wish = [&](int x, int y) {
    wishes.emplace_back(std::clamp(x, 0, std::max(0, picture.width - size.width)),
                        std::clamp(y, 0, std::max(0, picture.height - size.height)), size.width, size.height);
  };
  const cv::Point middle(object.x + object.width / 2 - size.width / 2,
                         object.y + object.height / 2 - size.height / 2);
  for (int step = 0; step < 8; ++step) {
    const int shift = (step % 2 ? 1 : -1) * ((step + 1) / 2) * size.height;
    wish(middle.x + 2 * shift, object.y - gap - size.height);
    wish(middle.x + 2 * shift, object.br().y + gap);
    wish(object.br().x + gap, middle.y + shift);
    wish(object.x - gap - size.width, middle.y + shift);
  }
  for (int y = 0; y + size.height <= picture.height; y += canvas.px(12)) wish(object.br().x + gap, y);
  const auto covers = [](const cv::Rect& box, const std::vector<cv::Rect>& others) {
    return std::any_of(others.begin(), others.end(),
                       [&](const cv::Rect& other) { return !(other & box).empty(); });
  };
  for (const bool strict : {true, false}) {
    for (const cv::Rect& box : wishes) {
      if (!covers(box, canvas.taken) && !(strict && covers(box, canvas.objects))) return box;
    }
  }
  return wishes[0];
}

std::string certificate(const PoseEstimate& estimate) {
  return fmt::format("{}, gap {:.3g}", to_string(estimate.status), estimate.gap);
}

void draw_estimate(Canvas& canvas, const CameraModel& camera, const PoseEstimate& estimate,
                   const ObjectModel* model, const cv::Scalar& colour,
                   std::vector<std::pair<Label, cv::Rect>>& labels) {
  const double s = canvas.scale;
  const auto pixel = [&](double v) { return static_cast<int>(std::lround(std::clamp(v * s, -1e6, 1e6))); };
  cv::Rect box(pixel(estimate.bbox[0]), pixel(estimate.bbox[1]), pixel(estimate.bbox[2]),
               pixel(estimate.bbox[3]));
  if (model) {
    const RigidTransform camera_from_model = estimate.camera_from_object * model->object_from_mesh.inverse();
    const cv::Mat mask = silhouette_mask(model->mesh, camera, camera_from_model, canvas.scale);
    const cv::Rect seen = cv::boundingRect(mask);
    if (!seen.empty()) {
      box = seen;
      tint(canvas, mask, colour);
      draw_outline(canvas, mask, colour);
    }
    const double length_m = model->bounding_radius_m > 0 ? 0.6 * model->bounding_radius_m : 0.05;
    draw_axes(canvas, camera, estimate.camera_from_object, length_m);
  } else {
    cv::rectangle(canvas.image, box, kInk, canvas.px(5), cv::LINE_AA);
    cv::rectangle(canvas.image, box, colour, canvas.px(2.4), cv::LINE_AA);
  }
  const std::string name = estimate.object_name.empty() ? fmt::format("object {}", estimate.object_id)
                                                        : printable(estimate.object_name);
  canvas.objects.push_back(box);
  labels.push_back({{{fmt::format("{}  {:.2f}", name, estimate.score), certificate(estimate)}, colour}, box});
}

}  // namespace

cv::Mat draw_overlay(const RgbdFrame& frame, const FrameResult& result,
                     const std::vector<ObjectModel>& models) {
  Canvas canvas;
  canvas.scale = std::clamp((kWantedWidth + frame.colour.cols - 1) / frame.colour.cols, 1, kMaxScale);
  cv::resize(frame.colour, canvas.image, {}, canvas.scale, canvas.scale, cv::INTER_CUBIC);
  canvas.unit = std::max(0.6, canvas.image.cols / 1280.0);
  CameraModel camera = frame.camera;
  camera.width = frame.colour.cols;
  camera.height = frame.colour.rows;

  // The farthest first, so that the outlines of nearer objects lie on top; colours by order of the answer.
  std::vector<std::pair<const PoseEstimate*, cv::Scalar>> order;
  std::vector<int> ids;
  for (const PoseEstimate& estimate : result.estimates) {
    const auto known = std::find(ids.begin(), ids.end(), estimate.object_id);
    const auto index = static_cast<std::size_t>(known - ids.begin());
    if (known == ids.end()) ids.push_back(estimate.object_id);
    order.emplace_back(&estimate, palette_colour(index));
  }
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.first->camera_from_object.translation().z() > b.first->camera_from_object.translation().z();
  });
  std::vector<std::pair<Label, cv::Rect>> labels;
  for (const auto& [estimate, colour] : order) {
    const auto model =
        std::find_if(models.begin(), models.end(),
                     [id = estimate->object_id](const ObjectModel& m) { return m.object_id == id; });
    draw_estimate(canvas, camera, *estimate, model == models.end() ? nullptr : &*model, colour, labels);
  }
  // Labels last: no outline crosses them.
  Label missing{{}, cv::Scalar(150, 155, 165)};
  for (const ObjectOutcome& object : result.objects) {
    const bool found = std::any_of(result.estimates.begin(), result.estimates.end(),
                                   [&](const PoseEstimate& e) { return e.object_id == object.object_id; });
    if (!found) missing.lines.push_back(printable(object.object_name) + ": " + to_string(object.status));
  }
  if (!missing.lines.empty()) {
    const cv::Size size = size_of(canvas, missing);
    const int margin = canvas.px(14);
    draw_label(canvas, missing, cv::Rect(cv::Point(margin, canvas.image.rows - margin - size.height), size));
  }
  for (const auto& [label, object] : labels) {
    draw_label(canvas, label, place_label(canvas, size_of(canvas, label), object));
  }
  return canvas.image;
}

}  // namespace sextant
