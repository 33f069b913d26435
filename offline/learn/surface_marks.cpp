// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/surface_marks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "runtime/features/edges.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/refine/contour_edges.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kAzimuths = 12;
constexpr std::array<double, 3> kElevationsDeg{15, 45, 75};
constexpr int kPicture = 401;    // pixels, square
constexpr int kShapeBorder = 4;  // pixels around silhouettes and creases that are not print
constexpr double kSpacingM = 0.004;
// Edges that survive dim light and blur.
constexpr EdgeOptions kStrong{100, 200};
constexpr double kFlattest = 0.45;  ///< cosine: seen more flatly, a mark's place is too uncertain

/// The camera for one view: the object fills the picture from three times its radius or more.
PinholeCamera camera_for() {
  constexpr double kFocal = 600;
  return {kPicture, kPicture, kFocal, kPicture / 2, kPicture / 2};
}

/// What is shape in this view: background and discontinuities of depth, silhouettes, creases; widened.
cv::Mat shape_mask(const RenderedView& view, const std::vector<EdgeSample>& contours) {
  cv::Mat mask = view.ray_depth_m == 0;
  for (const EdgeSample& s : contours) {
    mask.at<unsigned char>(static_cast<int>(std::lround(s.pixel.y())),
                           static_cast<int>(std::lround(s.pixel.x()))) = 255;
  }
  cv::Mat wide;
  const int side = 2 * kShapeBorder + 1;
  cv::dilate(mask, wide, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
  return wide;
}

/// Direction of the edge through a pixel: the main axis of the edge pixels around it that share its kind.
std::optional<Eigen::Vector2d> edge_direction(const cv::Mat& edges, int x, int y) {
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  int n = 0;
  const unsigned char kind = edges.at<unsigned char>(y, x);
  for (int dy = -3; dy <= 3; ++dy) {
    for (int dx = -3; dx <= 3; ++dx) {
      if ((edges.at<unsigned char>(y + dy, x + dx) & kind) == 0) continue;
      const Eigen::Vector2d d(dx, dy);
      scatter += d * d.transpose();
      ++n;
    }
  }
  if (n < 5) return std::nullopt;
  const double angle = 0.5 * std::atan2(2 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  const double mean = (scatter(0, 0) + scatter(1, 1)) / 2;
  const double spread = std::hypot((scatter(0, 0) - scatter(1, 1)) / 2, scatter(0, 1));
  if (spread < 0.75 * mean) return std::nullopt;  // a corner or a thicket
  return Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

/// The mark of an edge pixel, camera frame; nothing where the surface there is not smooth.
std::optional<SurfaceMark> mark_at(const RenderedView& view, const PinholeCamera& camera, int x, int y,
                                   const Eigen::Vector2d& direction) {
  const auto point = [&](int px, int py) -> Eigen::Vector3d {
    return camera.ray(px, py) * static_cast<double>(view.ray_depth_m.at<float>(py, px));
  };
  const Eigen::Vector3d centre = point(x, y);
  const Eigen::Vector3d right = point(x + 2, y) - point(x - 2, y);
  const Eigen::Vector3d down = point(x, y + 2) - point(x, y - 2);
  Eigen::Vector3d normal = down.cross(right).normalized();
  if (normal.dot(centre) > 0) normal = -normal;
  if (-normal.dot(centre.normalized()) < kFlattest) return std::nullopt;
  const Eigen::Vector3d along = (right * direction.x() + down * direction.y()).normalized();
  return SurfaceMark{centre.cast<float>(), along.cast<float>(), normal.cast<float>()};
}

}  // namespace

std::vector<SurfaceMark> find_surface_marks(Renderer& renderer, int mesh, const StandingObject& object,
                                            const ModelMesh& shape, std::size_t max_marks) {
  const PinholeCamera camera = camera_for();
  ObjectModel bare;
  bare.mesh = shape;
  ContourEdges contours(bare);
  DepthRaster raster;
  std::vector<EdgeSample> samples;
  std::map<std::array<int, 4>, SurfaceMark> cells;  ///< one mark per cell of space and direction
  for (const double elevation : kElevationsDeg) {
    for (int a = 0; a < kAzimuths; ++a) {
      Pose6 pose{camera.cx,
                 camera.cy,
                 3.2 * object.bounding_radius_m,
                 0,
                 -elevation * kDegree,
                 2 * std::numbers::pi * a / kAzimuths};
      const RigidTransform camera_from_object = transform_from_pose(camera, pose);
      // Light from everywhere: no shading, only colour. The background is no edge's business.
      const RenderedView view =
          renderer.render(camera, cv::Rect(0, 0, kPicture, kPicture), {{mesh, camera_from_object}},
                          Light{{0, 0, 0}, 1.0}, Eigen::Vector3d(128, 128, 128));
      raster.draw(shape, camera_from_object, camera);
      contours.sample(camera_from_object, camera, raster, 1, samples);
      const cv::Mat not_print = shape_mask(view, samples);
      const cv::Mat edges = edges_by_direction(view.colour, kStrong);
      const RigidTransform object_from_camera = camera_from_object.inverse();
      for (int y = 4; y < kPicture - 4; ++y) {
        for (int x = 4; x < kPicture - 4; ++x) {
          if (!edges.at<unsigned char>(y, x) || not_print.at<unsigned char>(y, x)) continue;
          const auto direction = edge_direction(edges, x, y);
          if (!direction) continue;
          auto mark = mark_at(view, camera, x, y, *direction);
          if (!mark) continue;
          const Eigen::Isometry3f back(object_from_camera.cast<float>());
          mark->point = back * mark->point;
          mark->direction = back.linear() * mark->direction;
          mark->normal = back.linear() * mark->normal;
          const auto cell = [&](int i) {
            return static_cast<int>(std::floor(static_cast<double>(mark->point[i]) / kSpacingM));
          };
          const Eigen::Vector3f d = mark->direction.cwiseAbs();
          int main_axis = 0;
          d.maxCoeff(&main_axis);
          cells.try_emplace({cell(0), cell(1), cell(2), main_axis}, *mark);
        }
      }
    }
  }
  // Spread evenly over the cells' order where there are too many.
  std::vector<SurfaceMark> marks;
  const std::size_t n = std::min(max_marks, cells.size());
  std::size_t k = 0;
  std::size_t taken = 0;
  for (const auto& [cell, mark] : cells) {
    if (k++ * n / cells.size() >= taken && taken < n) {
      marks.push_back(mark);
      ++taken;
    }
  }
  return marks;
}

}  // namespace sextant
