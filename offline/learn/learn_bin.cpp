// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/learn_bin.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "offline/learn/informative_parts.h"
#include "offline/learn/learn_depth.h"
#include "offline/learn/least_squares.h"
#include "offline/learn/nearest_feature.h"
#include "offline/learn/select_parts.h"
#include "offline/learn/view_scale.h"
#include "runtime/base/error.h"
#include "runtime/search/lattice.h"

namespace sextant {
namespace {

/// Share of the training views that must show a feature kind for its parts to be learnt.
constexpr double kLeastSeen = 0.95;
/// How often an edge is found where it should be, and by chance elsewhere, before anything was measured.
constexpr float kFoundShare = 0.75F;
constexpr float kFoundByChance = 0.15F;
/// Spacing of select_parts at which a part weighs 1: a fifth of the object's radius.
constexpr double kUsualSpacing = 0.1 * kLargestSpacing;

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
  std::vector<cv::Point> pixels(grid.size());
  for (const TrainingView& view : views) {
    const ViewScale scale(view, focal);
    std::vector<bool> rows(static_cast<std::size_t>(view.window.height), false);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      pixels[i] = scale.pixel(grid[i]);
      rows[static_cast<std::size_t>(pixels[i].y)] = true;
    }
    const std::vector<NearestFeature> nearest = nearest_features(view.edges, kind, rows);
    const auto first = static_cast<std::size_t>(pixels[0].y * view.window.width + pixels[0].x);
    if (nearest[first].column < 0) continue;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const cv::Point at = pixels[i];
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

Eigen::Vector4d centre_of(const RotationBox& box) {
  const auto middle = [&](std::size_t a) { return 0.5 * (box.lo_deg[a] + box.hi_deg[a] - 1) * kOneDegree; };
  return {1, middle(0), middle(1), middle(2)};
}

Eigen::Vector2d position_of(const VisualPart& part, const Eigen::Vector4d& rotation) {
  const auto at = [&](const std::array<float, 4>& form) {
    return Eigen::Vector4f(form[0], form[1], form[2], form[3]).cast<double>().dot(rotation);
  };
  return {at(part.u), at(part.v)};
}

/// Of candidates of one kind that predict the same place (within a pixel at 1 m) only the surest.
void keep_distinct(std::vector<VisualPart>& parts, const Eigen::Vector4d& centre) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const VisualPart& a, const VisualPart& b) { return a.variance < b.variance; });
  std::set<std::array<int, 3>> taken;
  std::erase_if(parts, [&](const VisualPart& p) {
    const Eigen::Vector2d at = position_of(p, centre) * kReferenceFocal;
    const std::array<int, 3> cell{p.kind, static_cast<int>(std::floor(at.x())),
                                  static_cast<int>(std::floor(at.y()))};
    return !taken.insert(cell).second;
  });
}

std::vector<VisualPart> learn_visual(const std::vector<TrainingView>& views,
                                     const std::vector<TestScene>& scenes, const LearnParameters& p,
                                     const Positions& grid, const RotationBox& box,
                                     std::array<bool, 4> active, double spacing_unit) {
  const double limit = p.visual_max_variance_px2 / (kReferenceFocal * kReferenceFocal);
  std::vector<VisualPart> parts;
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
      part.variance = static_cast<float>((u.squared_error + v.squared_error) / e.sums.freedom());
      part.radius = static_cast<float>(p.visual_radius_px / kReferenceFocal);
      if (part.variance <= limit) parts.push_back(part);
    }
  }
  const Eigen::Vector4d centre = centre_of(box);
  keep_distinct(parts, centre);
  std::vector<PartCandidate> candidates;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    candidates.push_back({parts[i].variance, position_of(parts[i], centre) / spacing_unit, parts[i].kind, i});
  }
  const ChosenParts picked = select_parts(
      std::move(candidates), static_cast<std::size_t>(std::max(p.visual_candidates, p.visual_parts)), limit);
  // Each part stands for the edge up to its neighbours.
  const double weight = std::clamp((picked.spacing + 1) / kUsualSpacing, 0.05, 20.0);
  std::vector<VisualPart> chosen;
  for (const PartCandidate& c : picked.parts) {
    chosen.push_back(parts[c.index]);
    chosen.back().seen.found = kFoundShare;
    chosen.back().seen.background = kFoundByChance;
    chosen.back().seen.weight = static_cast<float>(weight);
  }
  measure_parts(scenes, p.camera, chosen);
  keep_most_informative(chosen, static_cast<std::size_t>(p.visual_parts));
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

ViewpointBin learn_bin(const std::vector<TrainingView>& views, const std::vector<TestScene>& scenes,
                       const LearnParameters& parameters, const RotationBox& box, double bounding_radius_m) {
  std::array<bool, 4> active{true, true, true, true};
  for (std::size_t a = 0; a < 3; ++a) active[a + 1] = box.hi_deg[a] - box.lo_deg[a] > 1;
  const Positions grid = enumeration_grid(parameters.grid, bounding_radius_m);
  const double spacing_unit = 2 * bounding_radius_m / kLargestSpacing;
  ViewpointBin bin;
  bin.box = box;
  bin.visual = learn_visual(views, scenes, parameters, grid, box, active, spacing_unit);
  bin.depth = learn_depth(views, scenes, parameters, grid, box, active, spacing_unit, bounding_radius_m);
  bin.extent = mean_extent(views, parameters.camera.focal);
  return bin;
}

}  // namespace sextant
