// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/bundled/canvas.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace sextant {
namespace {

using Point = Eigen::Vector2d;

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
  const Point along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0;
  return (p - a - t * along).norm();
}

const char* strokes_of(char letter) {
  switch (letter) {
    case 'A':
      return "0,6 0,1.5 1.5,0 2.5,0 4,1.5 4,6;0,3.7 4,3.7";
    case 'B':
      return "0,3 3,3 4,2 4,1 3,0 0,0 0,6 3,6 4,5 4,4 3,3";
    case 'C':
      return "4,1 3,0 1,0 0,1 0,5 1,6 3,6 4,5";
    case 'D':
      return "0,0 3,0 4,1 4,5 3,6 0,6 0,0";
    case 'E':
      return "4,0 0,0 0,6 4,6;0,3 3,3";
    case 'F':
      return "4,0 0,0 0,6;0,3 3,3";
    case 'G':
      return "4,1 3,0 1,0 0,1 0,5 1,6 3,6 4,5 4,3 2.5,3";
    case 'H':
      return "0,0 0,6;4,0 4,6;0,3 4,3";
    case 'I':
      return "2,0 2,6";
    case 'K':
      return "0,0 0,6;4,0 0,4;1.3,2.8 4,6";
    case 'L':
      return "0,0 0,6 4,6";
    case 'M':
      return "0,6 0,0 2,3 4,0 4,6";
    case 'N':
      return "0,6 0,0 4,6 4,0";
    case 'O':
    case '0':
      return "1,0 3,0 4,1 4,5 3,6 1,6 0,5 0,1 1,0";
    case 'P':
      return "0,6 0,0 3,0 4,1 4,2 3,3 0,3";
    case 'R':
      return "0,6 0,0 3,0 4,1 4,2 3,3 0,3;2,3 4,6";
    case '5':
      return "4,0 0,0 0,3 3,3 4,4 4,5 3,6 0,6";
    case 'S':
      return "4,1 3,0 1,0 0,1 0,2 1,3 3,3 4,4 4,5 3,6 1,6 0,5";
    case 'T':
      return "0,0 4,0;2,0 2,6";
    case 'U':
      return "0,0 0,5 1,6 3,6 4,5 4,0";
    case 'V':
      return "0,0 2,6 4,0";
    case 'W':
      return "0,0 1,6 2,3 3,6 4,0";
    case 'X':
      return "0,0 4,6;4,0 0,6";
    case 'Y':
      return "0,0 2,3 4,0;2,3 2,6";
    case 'Z':
      return "0,0 4,0 0,6 4,6";
    case '1':
      return "1,1 2,0 2,6;1,6 3,6";
    case '2':
      return "0,1 1,0 3,0 4,1 4,2 0,6 4,6";
    case '4':
      return "3,6 3,0 0,4 4,4";
    default:
      return "";
  }
}

}  // namespace

std::vector<std::vector<Point>> letter_strokes(char letter) {
  std::vector<std::vector<Point>> strokes;
  std::istringstream all(strokes_of(letter));
  std::string stroke;
  while (std::getline(all, stroke, ';')) {
    std::vector<Point> points;
    std::istringstream in(stroke);
    char comma = 0;
    for (Point p; in >> p.x() >> comma >> p.y();) points.push_back(p);
    strokes.push_back(points);
  }
  return strokes;
}

Canvas::Canvas(double width_mm, double height_mm, double pixels_per_mm)
    : width_(static_cast<int>(std::lround(width_mm * pixels_per_mm))),
      height_(static_cast<int>(std::lround(height_mm * pixels_per_mm))),
      pixels_per_mm_(pixels_per_mm),
      panel_width_(width_mm),
      panel_height_(height_mm),
      pixels_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
              Eigen::Vector3f(255, 255, 255)) {}

void Canvas::panel(double x, double y, double width, double height) {
  panel_x_ = x;
  panel_y_ = y;
  panel_width_ = width;
  panel_height_ = height;
}

template <typename Distance>
void Canvas::paint_where(double x0, double y0, double x1, double y1, const Paint& paint,
                         const Distance& distance) {
  const double edge = 1 / pixels_per_mm_;
  const auto first = [&](double panel, double at) {
    return static_cast<int>(std::floor((panel + std::max(0.0, at - edge)) * pixels_per_mm_));
  };
  const auto last = [&](double panel, double at, double most, int size) {
    return std::min(size - 1,
                    static_cast<int>(std::ceil((panel + std::min(most, at + edge)) * pixels_per_mm_)) - 1);
  };
  for (int row = first(panel_y_, y0); row <= last(panel_y_, y1, panel_height_, height_); ++row) {
    for (int column = first(panel_x_, x0); column <= last(panel_x_, x1, panel_width_, width_); ++column) {
      const Point p((column + 0.5) / pixels_per_mm_ - panel_x_, (row + 0.5) / pixels_per_mm_ - panel_y_);
      const auto cover = static_cast<float>(std::clamp(0.5 - distance(p) * pixels_per_mm_, 0.0, 1.0));
      Eigen::Vector3f& pixel = pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                       static_cast<std::size_t>(column)];
      pixel += cover * (paint.cast<float>() - pixel);
    }
  }
}

void Canvas::rectangle(double x, double y, double width, double height, const Paint& paint,
                       double corner_radius) {
  const Point middle(x + width / 2, y + height / 2);
  const Point half(width / 2 - corner_radius, height / 2 - corner_radius);
  paint_where(x, y, x + width, y + height, paint, [&](const Point& p) {
    const Point beyond = (p - middle).cwiseAbs() - half;
    return beyond.cwiseMax(0).norm() + std::min(0.0, beyond.maxCoeff()) - corner_radius;
  });
}

void Canvas::disc(double x, double y, double radius, const Paint& paint) {
  paint_where(x - radius, y - radius, x + radius, y + radius, paint,
              [&](const Point& p) { return (p - Point(x, y)).norm() - radius; });
}

void Canvas::ring(double x, double y, double radius, double line_width, const Paint& paint) {
  const double reach = radius + line_width / 2;
  paint_where(x - reach, y - reach, x + reach, y + reach, paint,
              [&](const Point& p) { return std::abs((p - Point(x, y)).norm() - radius) - line_width / 2; });
}

void Canvas::polygon(const std::vector<Point>& corners, const Paint& paint) {
  Point lo = corners[0];
  Point hi = corners[0];
  double area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    lo = lo.cwiseMin(corners[i]);
    hi = hi.cwiseMax(corners[i]);
    const Point& next = corners[(i + 1) % corners.size()];
    area += corners[i].x() * next.y() - corners[i].y() * next.x();
  }
  const double turn = area > 0 ? 1 : -1;
  paint_where(lo.x(), lo.y(), hi.x(), hi.y(), paint, [&](const Point& p) {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Point along = (corners[(i + 1) % corners.size()] - corners[i]).normalized();
      most = std::max(most, turn * Point(along.y(), -along.x()).dot(p - corners[i]));
    }
    return most;
  });
}

void Canvas::line(const std::vector<Point>& points, double line_width, const Paint& paint) {
  Point lo = points[0];
  Point hi = points[0];
  for (const Point& p : points) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  const double reach = line_width / 2;
  paint_where(lo.x() - reach, lo.y() - reach, hi.x() + reach, hi.y() + reach, paint, [&](const Point& p) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      least = std::min(least, distance_to_segment(p, points[i], points[i + 1]));
    }
    return least - reach;
  });
}

void Canvas::text(const std::string& letters, double x, double y, double height, const Paint& paint,
                  double weight) {
  const double thickness = weight * height;
  const double unit = (height - thickness) / 6;
  const double advance = 4 * unit + 2.1 * thickness;
  double left = x - (advance * static_cast<double>(letters.size()) - 2.1 * thickness) / 2;
  for (const char letter : letters) {
    for (std::vector<Point> stroke : letter_strokes(letter)) {
      for (Point& p : stroke) p = Point(left, y + thickness / 2) + unit * p;
      line(stroke, thickness, paint);
    }
    left += advance;
  }
}

void Canvas::bars(double x, double y, double width, double height, const std::string& widths,
                  const Paint& paint) {
  double units = 0;
  for (const char c : widths) units += c - '0';
  double at = x;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const double bar = width * (widths[i] - '0') / units;
    if (i % 2 == 0) rectangle(at, y, bar, height, paint);
    at += bar;
  }
}

Paint Canvas::at(double x, double y) const {
  const int column = std::clamp(static_cast<int>(x * pixels_per_mm_), 0, width_ - 1);
  const int row = std::clamp(static_cast<int>(y * pixels_per_mm_), 0, height_ - 1);
  return pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(column)]
      .cast<double>();
}

cv::Mat Canvas::image() const {
  cv::Mat image(height_, width_, CV_8UC3);
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const Eigen::Vector3f& p = pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                         static_cast<std::size_t>(column)];
      for (int k = 0; k < 3; ++k)
        image.at<cv::Vec3b>(row, column)[k] = static_cast<std::uint8_t>(p[k] + 0.5F);
    }
  }
  return image;
}

}  // namespace sextant
