// SPDX-License-Identifier: Apache-2.0
#include "runtime/frame/table_estimate.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "runtime/frame/table_fit.h"

namespace sextant {
namespace {

constexpr int kRounds = 400;
constexpr int kReach = 24;  ///< grid cells between the three samples of a hypothesis, at most
constexpr std::size_t kFewest = 200;
constexpr std::size_t kScored = 1500;      ///< samples that hypotheses are compared on
constexpr double kLeastDownward = 0.0436;  ///< sine of 2.5 deg
constexpr double kMostUpsideDown = 0.174;  ///< sine of 10 deg: a camera that looks straight down has no up
constexpr double kRival = 0.8;             ///< support of a second plane that makes the first doubtful
constexpr double kFloorBelow =
    0.3;  ///< metres: a plane that far below another one is the floor under a table
constexpr double kOtherHeight = 0.03;  ///< metres between two tables

/// What a plane must satisfy to be taken for the table.
struct Usable {
  const TableEstimateOptions& options;
  double least_cosine;

  explicit Usable(const TableEstimateOptions& o) : options(o), least_cosine(std::cos(o.up_tolerance_rad)) {}
  bool operator()(const TablePlane& plane) const {
    if (!(plane.height >= options.lowest_m && plane.height <= options.highest_m)) return false;
    if (options.up_in_camera) return plane.up.dot(*options.up_in_camera) >= least_cosine;
    return -plane.up.z() > kLeastDownward && -plane.up.y() > -kMostUpsideDown;
  }
};

struct Hypothesis {
  TablePlane plane;
  double support = 0;  ///< samples, each weighted by how well it fits
};

/// Plane through a point, normal turned towards the camera.
TablePlane plane_at(const Eigen::Vector3d& point, Eigen::Vector3d up) {
  if (up.dot(point) > 0) up = -up;
  return {up, -up.dot(point)};
}

double support_of(const TablePlane& plane, const std::vector<Eigen::Vector3d>& samples) {
  double support = 0;
  for (const Eigen::Vector3d& p : samples) {
    const double limit = 5 * depth_deviation(p.z());
    const double r = plane.above(p) / limit;
    support += std::max(0.0, 1 - r * r);
  }
  return support;
}

Hypothesis best_hypothesis(const TablePoints& points, const std::vector<std::size_t>& usable_cells,
                           const Usable& usable) {
  std::mt19937 random(1);  // fixed: the same image gives the same plane
  std::vector<Eigen::Vector3d> scored;
  const std::size_t step = std::max<std::size_t>(1, usable_cells.size() / kScored);
  for (std::size_t i = 0; i < usable_cells.size(); i += step) {
    scored.push_back(points.points[usable_cells[i]].cast<double>());
  }
  const auto neighbour = [&](int x, int y) -> Eigen::Vector3d {
    const auto offset = [&] { return static_cast<int>(random() % (2 * kReach + 1)) - kReach; };
    const int dx = offset();
    const int dy = offset();
    return points.at(std::clamp(x + dx, 0, points.columns - 1), std::clamp(y + dy, 0, points.rows - 1))
        .cast<double>();
  };
  Hypothesis best;
  for (int round = 0; round < kRounds; ++round) {
    const std::size_t cell = usable_cells[random() % usable_cells.size()];
    const int x = static_cast<int>(cell) % points.columns;
    const int y = static_cast<int>(cell) / points.columns;
    const Eigen::Vector3d a = points.points[cell].cast<double>();
    const Eigen::Vector3d b = neighbour(x, y);
    const Eigen::Vector3d c = neighbour(x, y);
    if (b.z() <= 0 || c.z() <= 0) continue;
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    // Thin triangles say nothing about the normal.
    if (normal.norm() < 0.2 * (b - a).norm() * (c - a).norm() || normal.norm() < 1e-6) continue;
    const TablePlane plane = plane_at(a, normal.normalized());
    if (!usable(plane)) continue;
    const double support = support_of(plane, scored);
    if (support > best.support) best = {plane, support};
  }
  return best;
}

std::string in_words(const TableFit& fit) {
  const TableGeometry t{fit.plane.up, fit.plane.height};
  constexpr double kDegrees = 57.29577951308232;
  return fmt::format("{:.2f} m below, pitch {:.0f} deg", t.camera_height_m, t.pitch_rad() * kDegrees);
}

TableEstimate estimate_of(const TableFit& fit, std::size_t samples) {
  return {{fit.plane.up, fit.plane.height},
          fit.uncertainty,
          static_cast<double>(fit.inliers) / static_cast<double>(samples),
          fit.residual_m};
}

tl::unexpected<NoTable> refuse(std::string reason) { return tl::make_unexpected(NoTable{std::move(reason)}); }

}  // namespace

tl::expected<TableEstimate, NoTable> estimate_table(const TablePoints& points,
                                                    const TableEstimateOptions& options) {
  std::vector<std::size_t> cells;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    if (points.points[i].z() > 0) cells.push_back(i);
  }
  if (cells.size() < kFewest) {
    return refuse(
        fmt::format("only {} of {} samples have depth; look at the depth stream (sextant camera check)",
                    cells.size(), points.points.size()));
  }
  const Usable usable(options);
  const Hypothesis first = best_hypothesis(points, cells, usable);
  if (first.support == 0) {
    return refuse("no plane below the camera; point it at the table, or give the direction of gravity");
  }
  const TableFit fit = fit_table(points, first.plane);
  const double share = static_cast<double>(fit.inliers) / static_cast<double>(cells.size());
  if (fit.inliers == 0 || share < options.least_share || !usable(fit.plane)) {
    return refuse(
        fmt::format("the largest plane below the camera has {:.0f} % of the depth, {:.0f} % are needed; "
                    "show more of the table",
                    100 * share, 100 * options.least_share));
  }
  // Is there a second one, parallel but at another height?
  std::vector<std::size_t> rest;
  for (const std::size_t i : cells) {
    if (!lies_on(fit.plane, points.points[i].cast<double>(), 2)) rest.push_back(i);
  }
  const double needed = options.least_share * static_cast<double>(cells.size());
  if (static_cast<double>(rest.size()) > needed) {
    const Hypothesis second = best_hypothesis(points, rest, usable);
    const TableFit rival = second.support > 0 ? fit_table(points, second.plane) : TableFit{};
    const bool parallel = rival.plane.up.dot(fit.plane.up) > 0.985;
    if (rival.inliers > needed && parallel && usable(rival.plane)) {
      const double above = fit.plane.height - rival.plane.height;
      // A floor below the table may fill more of the image.
      if (above > kFloorBelow) return estimate_of(rival, cells.size());
      if (rival.inliers > kRival * fit.inliers && std::abs(above) > kOtherHeight && above > -kFloorBelow) {
        return refuse(fmt::format("two planes could be the table: {} and {}; narrow the height down",
                                  in_words(fit), in_words(rival)));
      }
    }
  }
  return estimate_of(fit, cells.size());
}

tl::expected<TableEstimate, NoTable> estimate_table(const SearchFrame& frame,
                                                    const TableEstimateOptions& options) {
  return estimate_table(table_points(frame), options);
}

}  // namespace sextant
