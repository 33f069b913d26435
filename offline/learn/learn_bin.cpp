// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/learn_bin.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "offline/learn/least_squares.h"
#include "offline/learn/nearest_feature.h"
#include "offline/learn/select_parts.h"
#include "runtime/base/error.h"
#include "runtime/search/lattice.h"

namespace sextant {
namespace {

/// Share of the training views that must show a feature kind for its parts to be learnt.
constexpr double kLeastSeen = 0.95;

using Positions = std::vector<Eigen::Vector2d>;

/// Enumeration positions: a grid over the square of the bounding sphere, tangent * metre.
Positions enumeration_grid(int side, double radius_m) {
  Positions grid;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      grid.emplace_back(radius_m * (2.0 * (i + 0.5) / side - 1), radius_m * (2.0 * (j + 0.5) / side - 1));
    }
  }
  return grid;
}

/// Maps between a view's pixels and tangent * metre around the object's centre.
struct ViewScale {
  const TrainingView& view;
  double scale;  ///< pixels per (tangent * metre)

  ViewScale(const TrainingView& v, double focal) : view(v), scale(focal / v.pose.z) {}
  /// Pixel of the window, clamped to it.
  cv::Point pixel(const Eigen::Vector2d& p) const {
    const auto at = [&](double centre, double offset, int origin, int size) {
      return std::clamp(static_cast<int>(std::floor(centre + scale * offset + 0.5)) - origin, 0, size - 1);
    };
    return {at(view.pose.x, p.x(), view.window.x, view.window.width),
            at(view.pose.y, p.y(), view.window.y, view.window.height)};
  }
  Eigen::Vector2d position(int column, int row) const {
    return {(column + view.window.x - view.pose.x) / scale, (row + view.window.y - view.pose.y) / scale};
  }
};

Eigen::Vector3d rotation_of(const TrainingView& view) { return {view.pose.rx, view.pose.ry, view.pose.rz}; }

/// Fits of all labels of one kind, and which labels were seen in every view.
struct Enumeration {
  LeastSquares sums;
  std::vector<bool> complete;
  Enumeration(std::size_t labels, std::array<bool, 4> active)
      : sums(labels, active), complete(labels, true) {}
};

/// Position of the nearest feature of one kind for every grid position (u and v interleaved). Views without
/// any feature of the kind are left out; a kind that too many views lack is not complete.
Enumeration enumerate_visual(const std::vector<TrainingView>& views, const Positions& grid, int kind,
                             double focal, std::array<bool, 4> active) {
  Enumeration e(2 * grid.size(), active);
  std::vector<float> labels(2 * grid.size());
  for (const TrainingView& view : views) {
    const ViewScale scale(view, focal);
    const std::vector<NearestFeature> nearest = nearest_features(view.edges, kind);
    if (nearest[0].column < 0) continue;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const cv::Point at = scale.pixel(grid[i]);
      const NearestFeature f = nearest[static_cast<std::size_t>(at.y * view.window.width + at.x)];
      const Eigen::Vector2d p = scale.position(f.column, f.row);
      labels[2 * i] = static_cast<float>(p.x());
      labels[2 * i + 1] = static_cast<float>(p.y());
    }
    e.sums.add(rotation_of(view), labels);
  }
  if (e.sums.examples() < kLeastSeen * static_cast<double>(views.size()))
    e.complete.assign(e.complete.size(), false);
  return e;
}

/// Depth relative to the centre's distance at every grid position.
Enumeration enumerate_depth(const std::vector<TrainingView>& views, const Positions& grid, double focal,
                            std::array<bool, 4> active) {
  Enumeration e(grid.size(), active);
  std::vector<float> labels(grid.size());
  for (const TrainingView& view : views) {
    const ViewScale scale(view, focal);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const float depth = view.ray_depth_m.at<float>(scale.pixel(grid[i]));
      if (depth <= 0) e.complete[i] = false;
      labels[i] = depth > 0 ? static_cast<float>(depth - view.pose.z) : 0.0F;
    }
    e.sums.add(rotation_of(view), labels);
  }
  return e;
}

Eigen::Vector4d centre_of(const RotationBox& box) {
  const auto middle = [&](std::size_t a) {
    return 0.5 * (box.lo_deg[a] + box.hi_deg[a] - 1) * kLatticeAngle;
  };
  return {1, middle(0), middle(1), middle(2)};
}

std::array<float, 4> to_floats(const Eigen::Vector4d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
          static_cast<float>(v[3])};
}

std::vector<VisualPart> learn_visual(const std::vector<TrainingView>& views, const LearnParameters& p,
                                     const Positions& grid, const RotationBox& box,
                                     std::array<bool, 4> active, double spacing_unit) {
  std::vector<PartCandidate> candidates;
  std::vector<VisualPart> parts;
  const Eigen::Vector4d centre = centre_of(box);
  for (int kind = 0; kind < kFeatureKinds; ++kind) {
    Enumeration e = enumerate_visual(views, grid, kind, p.camera.focal, active);
    if (!e.complete[0] || !e.sums.finish()) continue;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const LinearFit u = e.sums.fit(2 * i);
      const LinearFit v = e.sums.fit(2 * i + 1);
      VisualPart part;
      part.kind = static_cast<std::uint8_t>(kind);
      part.u = to_floats(u.coefficients);
      part.v = to_floats(v.coefficients);
      const double variance = (u.squared_error + v.squared_error) / e.sums.freedom();
      part.variance = static_cast<float>(variance);
      part.radius = static_cast<float>(p.visual_radius_px / kReferenceFocal);
      const Eigen::Vector2d at(u.coefficients.dot(centre), v.coefficients.dot(centre));
      candidates.push_back({variance, at / spacing_unit, kind, parts.size()});
      parts.push_back(part);
    }
  }
  const double limit = p.visual_max_variance_px2 / (kReferenceFocal * kReferenceFocal);
  std::vector<VisualPart> chosen;
  for (const PartCandidate& c :
       select_parts(std::move(candidates), static_cast<std::size_t>(p.visual_parts), limit)) {
    chosen.push_back(parts[c.index]);
  }
  return chosen;
}

std::vector<DepthPart> learn_depth(const std::vector<TrainingView>& views, const LearnParameters& p,
                                   const Positions& grid, std::array<bool, 4> active, double spacing_unit) {
  Enumeration e = enumerate_depth(views, grid, p.camera.focal, active);
  if (!e.sums.finish()) return {};
  std::vector<PartCandidate> candidates;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!e.complete[i]) continue;
    candidates.push_back({e.sums.fit(i).squared_error / e.sums.freedom(), grid[i] / spacing_unit, 0, i});
  }
  std::vector<DepthPart> chosen;
  for (const PartCandidate& c : select_parts(std::move(candidates), static_cast<std::size_t>(p.depth_parts),
                                             p.depth_max_variance_m2)) {
    DepthPart part;
    part.px = static_cast<float>(grid[c.index].x());
    part.py = static_cast<float>(grid[c.index].y());
    part.d = to_floats(e.sums.fit(c.index).coefficients);
    part.variance = static_cast<float>(c.variance);
    part.radius = static_cast<float>(p.depth_radius_m);
    part.missing = static_cast<float>(p.missing_depth_m);
    chosen.push_back(part);
  }
  return chosen;
}

/// Mean over the views of the object's box around its centre, tangent * metre.
std::array<float, 4> mean_extent(const std::vector<TrainingView>& views, double focal) {
  Eigen::Vector4d sum = Eigen::Vector4d::Zero();
  int seen = 0;
  for (const TrainingView& view : views) {
    const cv::Mat mask = view.ray_depth_m > 0;
    std::vector<int> columns;
    int x0 = mask.cols;
    int x1 = -1;
    int y0 = mask.rows;
    int y1 = -1;
    for (int y = 0; y < mask.rows; ++y) {
      const auto* row = mask.ptr<std::uint8_t>(y);
      for (int x = 0; x < mask.cols; ++x) {
        if (!row[x]) continue;
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        y0 = std::min(y0, y);
        y1 = std::max(y1, y);
      }
    }
    if (x1 < 0) continue;
    const ViewScale scale(view, focal);
    const Eigen::Vector2d lo = scale.position(x0, y0);
    const Eigen::Vector2d hi = scale.position(x1, y1);
    sum += Eigen::Vector4d(lo.x(), lo.y(), hi.x(), hi.y());
    ++seen;
  }
  if (seen == 0) throw std::logic_error("the object is in none of its training views");
  return to_floats(sum / seen);
}

}  // namespace

ViewpointBin learn_bin(const std::vector<TrainingView>& views, const LearnParameters& parameters,
                       const RotationBox& box, double bounding_radius_m) {
  std::array<bool, 4> active{true, true, true, true};
  for (std::size_t a = 0; a < 3; ++a) active[a + 1] = box.hi_deg[a] - box.lo_deg[a] > 1;
  const Positions grid = enumeration_grid(parameters.grid, bounding_radius_m);
  const double spacing_unit = 2 * bounding_radius_m / kLargestSpacing;
  ViewpointBin bin;
  bin.box = box;
  bin.visual = learn_visual(views, parameters, grid, box, active, spacing_unit);
  bin.depth = learn_depth(views, parameters, grid, active, spacing_unit);
  bin.extent = mean_extent(views, parameters.camera.focal);
  return bin;
}

}  // namespace sextant
