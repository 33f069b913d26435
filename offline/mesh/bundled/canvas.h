// SPDX-License-Identifier: Apache-2.0
// A small painter for the prints on the bundled objects: antialiased shapes by signed distance, a stroke
// font, one PNG. Only +, -, *, /, sqrt: the same picture on every machine.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace sextant {

/// RGB, 0..255.
using Paint = Eigen::Vector3d;

/// A picture with coordinates in millimetres, x to the right, y down from the upper left corner of the
/// current panel.
class Canvas {
 public:
  Canvas(double width_mm, double height_mm, double pixels_per_mm);

  /// What follows is drawn relative to this rectangle and only inside of it.
  void panel(double x, double y, double width, double height);

  void rectangle(double x, double y, double width, double height, const Paint& paint,
                 double corner_radius = 0);
  void disc(double x, double y, double radius, const Paint& paint);
  void ring(double x, double y, double radius, double line_width, const Paint& paint);
  /// Convex, either way round.
  void polygon(const std::vector<Eigen::Vector2d>& corners, const Paint& paint);
  /// Round ends and corners.
  void line(const std::vector<Eigen::Vector2d>& points, double line_width, const Paint& paint);
  /// Capital letters, digits and spaces; `x` is the middle of the text, `y` the top of its letters.
  void text(const std::string& letters, double x, double y, double height, const Paint& paint,
            double weight = 0.17);
  /// Bars of a bar code with the given widths in units, alternating dark and light.
  void bars(double x, double y, double width, double height, const std::string& widths, const Paint& paint);

  /// Colour at a place, millimetres from the whole picture's corner.
  Paint at(double x, double y) const;
  /// CV_8UC3 RGB.
  cv::Mat image() const;

 private:
  template <typename Distance>
  void paint_where(double x0, double y0, double x1, double y1, const Paint& paint, const Distance& distance);

  int width_, height_;
  double pixels_per_mm_;
  double panel_x_ = 0, panel_y_ = 0, panel_width_, panel_height_;
  std::vector<Eigen::Vector3f> pixels_;
};

/// Strokes of a letter on a grid 4 wide and 6 high, y down; empty for unknown ones.
std::vector<std::vector<Eigen::Vector2d>> letter_strokes(char letter);

}  // namespace sextant
