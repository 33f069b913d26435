// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/learn_depth.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "offline/learn/select_parts.h"
#include "runtime/model/quantisation.h"
#include "runtime/search/lattice.h"

namespace sextant {
namespace {

/// Share of the views in which the object, or the table, must be seen for a part to expect it.
constexpr double kLeastShare = 0.5;
/// How often what a view shows is also seen through clutter and noise, and how often by chance.
constexpr double kUnhidden = 0.85;
constexpr float kObjectByChance = 0.2F;
constexpr float kTableByChance = 0.5F;
/// Parts of a bin at which each weighs 1: depth says as much in total however finely it is sampled.
constexpr double kUsualParts = 150;

/// Least squares at one position over the views that show one thing there.
struct PartialFit {
  Eigen::Matrix4d ata = Eigen::Matrix4d::Zero();
  Eigen::Vector4d atb = Eigen::Vector4d::Zero();
  double btb = 0;
  int examples = 0;

  void add(const Eigen::Vector4d& row, double value) {
    ata.noalias() += row * row.transpose();
    atb += row * value;
    btb += value * value;
    ++examples;
  }
  /// Coefficients, and the variance about them; a variance below 0 says that there are too few examples.
  std::pair<Eigen::Vector4d, double> solve(std::array<bool, 4> active) const {
    int columns = 0;
    Eigen::Matrix4d a = ata;
    Eigen::Vector4d b = atb;
    for (Eigen::Index i = 0; i < 4; ++i) {
      if (active[static_cast<std::size_t>(i)]) {
        ++columns;
        continue;
      }
      a.row(i).setZero();
      a.col(i).setZero();
      a(i, i) = 1;
      b(i) = 0;
    }
    if (examples < columns + 4) return {Eigen::Vector4d::Zero(), -1};
    const Eigen::Vector4d x = a.ldlt().solve(b);
    if (!x.allFinite()) return {Eigen::Vector4d::Zero(), -1};
    return {x, std::max(0.0, btb - x.dot(b)) / (examples - columns)};
  }
};

/// What the views show at one position.
struct Spot {
  PartialFit object;
  PartialFit table;
};

std::vector<Spot> look_at(const std::vector<TrainingView>& views, const Positions& positions, double focal,
                          std::array<bool, 4> active) {
  std::vector<Spot> spots(positions.size());
  for (const TrainingView& view : views) {
    const ViewScale scale(view, focal);
    Eigen::Vector4d row;
    row << 1, rotation_of(view);
    for (Eigen::Index i = 1; i < 4; ++i) {
      if (!active[static_cast<std::size_t>(i)]) row(i) = 0;
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const cv::Point at = scale.pixel(positions[i]);
      const float object = view.ray_depth_m.at<float>(at);
      const float table = view.table_depth_m.empty() ? 0 : view.table_depth_m.at<float>(at);
      if (object > 0) spots[i].object.add(row, object - view.pose.z);
      if (table > 0) spots[i].table.add(row, table - view.pose.z);
    }
  }
  return spots;
}

/// Largest absolute value of a linear form in a box.
double largest_in(const RotationBox& box, const Eigen::Vector4d& form) {
  double centre = form[0];
  double around = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double slope = form[static_cast<Eigen::Index>(a) + 1] * kOneDegree;
    centre += slope * 0.5 * (box.lo_deg[a] + box.hi_deg[a]);
    around += std::abs(slope) * 0.5 * (box.hi_deg[a] - box.lo_deg[a]);
  }
  return std::abs(centre) + around;
}

}  // namespace

std::vector<DepthPart> learn_depth(const std::vector<TrainingView>& views,
                                   const std::vector<TestScene>& scenes, const LearnParameters& parameters,
                                   const Positions& positions, const RotationBox& box,
                                   std::array<bool, 4> active, double spacing_unit,
                                   double bounding_radius_m) {
  const double reach = kDepthReach * rounding_limit_scale(bounding_radius_m);
  const std::vector<Spot> spots = look_at(views, positions, parameters.camera.focal, active);
  std::vector<DepthPart> parts;
  std::vector<PartCandidate> candidates;
  double radius2 = 0;
  for (const Eigen::Vector2d& p : positions) radius2 = std::max({radius2, p.x() * p.x(), p.y() * p.y()});
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i].squaredNorm() > radius2) continue;
    const auto total = static_cast<double>(views.size());
    const bool on_object = spots[i].object.examples >= kLeastShare * total;
    const bool on_table = !on_object && spots[i].table.examples >= kLeastShare * total;
    if (!on_object && !(on_table && parameters.learn_table != 0)) continue;
    const PartialFit& fit = on_object ? spots[i].object : spots[i].table;
    const auto [coefficients, variance] = fit.solve(active);
    if (variance < 0 || variance > parameters.depth_max_variance_m2) continue;
    if (largest_in(box, coefficients) > reach) continue;
    DepthPart part;
    part.px = static_cast<float>(positions[i].x());
    part.py = static_cast<float>(positions[i].y());
    part.d = to_floats(coefficients);
    part.variance = static_cast<float>(std::max(variance, 1e-12));
    part.radius = static_cast<float>(parameters.depth_radius_m);
    part.missing = static_cast<float>(parameters.missing_depth_m);
    part.role = on_table                                         ? DepthRole::kTable
                : fit.examples == static_cast<int>(views.size()) ? DepthRole::kObject
                                                                 : DepthRole::kRim;
    part.seen.found = static_cast<float>(kUnhidden * fit.examples / total);
    part.seen.background = on_table ? kTableByChance : kObjectByChance;
    candidates.push_back({variance, positions[i] / spacing_unit, 0, parts.size()});
    parts.push_back(part);
  }
  std::vector<DepthPart> chosen;
  for (const PartCandidate& c :
       select_parts(std::move(candidates), static_cast<std::size_t>(parameters.depth_parts),
                    parameters.depth_max_variance_m2)
           .parts) {
    chosen.push_back(parts[c.index]);
  }
  const double weight =
      std::clamp(kUsualParts / static_cast<double>(std::max<std::size_t>(1, chosen.size())), 0.25, 4.0);
  for (DepthPart& part : chosen) part.seen.weight = static_cast<float>(weight);
  measure_parts(scenes, parameters.camera, chosen);
  return chosen;
}

}  // namespace sextant
