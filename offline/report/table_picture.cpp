// SPDX-License-Identifier: Apache-2.0
#include "offline/report/table_picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace sextant {
namespace {

constexpr double kGrid = 0.1;      ///< metres
constexpr double kReach = 0.8;     ///< metres to each side of where the optical axis meets the table
constexpr double kOnTable = 0.01;  ///< metres
constexpr int kLineHeight = 22;    ///< pixels of a line of text

/// Pixel of a point; nothing where it is behind the camera or outside.
std::optional<cv::Point> pixel_of(const CameraModel& camera, const Eigen::Vector3d& p) {
  if (p.z() < 0.05) return std::nullopt;
  const Eigen::Vector2d at = camera.distorted_pixel({p.x() / p.z(), p.y() / p.z()});
  if (!(at.x() >= 0 && at.y() >= 0 && at.x() < camera.width && at.y() < camera.height)) return std::nullopt;
  return cv::Point(static_cast<int>(at.x()), static_cast<int>(at.y()));
}

/// Is something between the camera and this point of the table?
bool hidden(const RgbdFrame& frame, cv::Point at, const Eigen::Vector3d& p) {
  const float z = frame.axial_depth_m.at<float>(at.y, at.x);
  return z > 0 && z < p.z() - 0.02;
}

void draw_line(cv::Mat& image, const RgbdFrame& frame, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
               const cv::Scalar& colour) {
  constexpr int kPieces = 80;
  std::optional<cv::Point> last;
  for (int i = 0; i <= kPieces; ++i) {
    const Eigen::Vector3d p = from + (to - from) * (static_cast<double>(i) / kPieces);
    std::optional<cv::Point> at = pixel_of(frame.camera, p);
    if (at && hidden(frame, *at, p)) at.reset();
    if (at && last) cv::line(image, *last, *at, colour, 1, cv::LINE_AA);
    last = at;
  }
}

void draw_grid(cv::Mat& image, const RgbdFrame& frame, const TableGeometry& table) {
  const Eigen::Vector3d& up = table.up_in_camera;
  const double down = std::max(0.1, -up.z());
  const Eigen::Vector3d centre(0, 0, std::min(table.camera_height_m / down, 3.0));
  const Eigen::Vector3d origin = centre - up * (up.dot(centre) + table.camera_height_m);
  // Lines away from the camera and across.
  Eigen::Vector3d away = Eigen::Vector3d::UnitZ() - up * up.z();
  if (away.norm() < 1e-3) away = Eigen::Vector3d::UnitY() - up * up.y();
  away.normalize();
  const Eigen::Vector3d across = away.cross(up);
  const int lines = static_cast<int>(kReach / kGrid);
  for (int i = -lines; i <= lines; ++i) {
    const cv::Scalar colour = i == 0 ? cv::Scalar(255, 80, 60) : cv::Scalar(60, 255, 120);
    const Eigen::Vector3d a = origin + across * (kGrid * i);
    const Eigen::Vector3d b = origin + away * (kGrid * i);
    draw_line(image, frame, a - away * kReach, a + away * kReach, colour);
    draw_line(image, frame, b - across * kReach, b + across * kReach, colour);
  }
}

cv::Mat depth_picture(const RgbdFrame& frame) {
  const cv::Mat& depth = frame.axial_depth_m;
  std::vector<float> values;
  for (int y = 0; y < depth.rows; y += 4) {
    for (int x = 0; x < depth.cols; x += 4) {
      if (depth.at<float>(y, x) > 0) values.push_back(depth.at<float>(y, x));
    }
  }
  if (values.empty()) return cv::Mat::zeros(depth.size(), CV_8UC3);
  std::sort(values.begin(), values.end());
  const float near = values[values.size() / 50];
  const float far = std::max(near + 0.05F, values[values.size() - 1 - values.size() / 50]);
  cv::Mat grey(depth.size(), CV_8UC1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float share = std::clamp((depth.at<float>(y, x) - near) / (far - near), 0.0F, 1.0F);
      grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(255.0F * (1 - share));
    }
  }
  cv::Mat bgr;
  cv::Mat out;
  cv::applyColorMap(grey, bgr, cv::COLORMAP_JET);
  cv::cvtColor(bgr, out, cv::COLOR_BGR2RGB);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      cv::Vec3b& pixel = out.at<cv::Vec3b>(y, x);
      if (!(z > 0)) {
        pixel = {0, 0, 0};
        continue;
      }
      if (!frame.table) continue;
      // Good enough for a picture: the lens is ignored.
      const Eigen::Vector3d p((x - frame.camera.cx) / frame.camera.fx * z,
                              (y - frame.camera.cy) / frame.camera.fy * z, z);
      const double above = frame.table->up_in_camera.dot(p) + frame.table->camera_height_m;
      if (std::abs(above) < kOnTable) {
        for (int k = 0; k < 3; ++k) pixel[k] = static_cast<std::uint8_t>(160 + pixel[k] * 95 / 255);
      }
    }
  }
  return out;
}

}  // namespace

cv::Mat draw_table_picture(const RgbdFrame& frame, const std::vector<std::string>& lines) {
  cv::Mat colour = frame.colour.clone();
  if (frame.table) draw_grid(colour, frame, *frame.table);
  const int width = 2 * frame.colour.cols;
  const int text = static_cast<int>(lines.size()) * kLineHeight + 8;
  cv::Mat out(frame.colour.rows + text, width, CV_8UC3, cv::Scalar(24, 24, 24));
  colour.copyTo(out(cv::Rect(0, 0, colour.cols, colour.rows)));
  depth_picture(frame).copyTo(out(cv::Rect(colour.cols, 0, colour.cols, colour.rows)));
  int y = frame.colour.rows + kLineHeight - 4;
  for (const std::string& line : lines) {
    cv::putText(out, line, {8, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(230, 230, 230), 1, cv::LINE_AA);
    y += kLineHeight;
  }
  return out;
}

}  // namespace sextant
