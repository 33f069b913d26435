// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/annotate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace sextant {

namespace {

constexpr double kAxisLengthMetres = 0.05;
constexpr double kNearestMetres = 1e-3;
/// OpenCV draws wrong lines far outside the image.
constexpr double kFarthestPixel = 20'000;

std::optional<cv::Point> project(const CameraModel& camera, const Eigen::Vector3d& p_in_camera) {
  if (p_in_camera.z() < kNearestMetres) return std::nullopt;
  const Eigen::Vector2d pixel =
      camera.distorted_pixel({p_in_camera.x() / p_in_camera.z(), p_in_camera.y() / p_in_camera.z()});
  if (!(pixel.cwiseAbs().maxCoeff() < kFarthestPixel)) return std::nullopt;
  return cv::Point(cvRound(pixel.x()), cvRound(pixel.y()));
}

cv::Scalar colour_of(double score) {
  const double s = std::clamp(score, 0.0, 1.0);
  return {255 * std::min(1.0, 2 * (1 - s)), 255 * std::min(1.0, 2 * s), 0};
}

bool draw_outline(cv::Mat& image, const CameraModel& camera, const PoseEstimate& estimate,
                  const ObjectShape& shape) {
  cv::Mat mask = cv::Mat::zeros(image.size(), CV_8UC1);
  for (std::size_t i = 0; i + 2 < shape.corners.size(); i += 3) {
    std::array<cv::Point, 3> triangle;
    bool visible = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto pixel = project(camera, estimate.camera_from_object * shape.corners[i + k].cast<double>());
      visible = visible && pixel;
      if (pixel) triangle[k] = *pixel;
    }
    if (visible) cv::fillConvexPoly(mask, triangle, cv::Scalar(255));
  }
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(image, outlines, -1, colour_of(estimate.score), 2, cv::LINE_AA);
  return !outlines.empty();
}

void draw_axes(cv::Mat& image, const CameraModel& camera, const PoseEstimate& estimate) {
  const auto origin = project(camera, estimate.camera_from_object.translation());
  const std::array<cv::Scalar, 3> colours = {cv::Scalar(255, 0, 0), cv::Scalar(0, 255, 0),
                                             cv::Scalar(0, 0, 255)};
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d end = kAxisLengthMetres * Eigen::Vector3d::Unit(axis);
    const auto tip = project(camera, estimate.camera_from_object * end);
    if (origin && tip)
      cv::line(image, *origin, *tip, colours[static_cast<std::size_t>(axis)], 2, cv::LINE_AA);
  }
}

}  // namespace

cv::Mat annotate(const RgbdFrame& frame, const FrameResult& result, const ObjectShapes& shapes) {
  cv::Mat image = frame.colour.clone();
  for (const PoseEstimate& estimate : result.estimates) {
    const cv::Rect box(cvRound(estimate.bbox[0]), cvRound(estimate.bbox[1]), cvRound(estimate.bbox[2]),
                       cvRound(estimate.bbox[3]));
    const auto shape = shapes.find(estimate.object_name);
    const bool drawn = shape != shapes.end() && draw_outline(image, frame.camera, estimate, shape->second);
    if (!drawn) cv::rectangle(image, box, colour_of(estimate.score), 2);
    draw_axes(image, frame.camera, estimate);
    const std::string text =
        fmt::format("{} {:.2f} {}", estimate.object_name, estimate.score, to_string(estimate.status));
    const cv::Point at(std::max(0, box.x), std::max(14, box.y - 6));
    cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(0, 0, 0), 3, cv::LINE_AA);
    cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, colour_of(estimate.score), 1, cv::LINE_AA);
  }
  return image;
}

}  // namespace sextant
