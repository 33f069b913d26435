// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/convex_hull.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

namespace sextant {
namespace {

constexpr std::size_t kMaxHullPoints = 100'000;
constexpr int kDirectionsPerEdge = 128;  // of a cube's face

// Which of 6 * 128 * 128 directions of a cube map a vector points to.
std::size_t direction_of(const Eigen::Vector3d& v) {
  int axis = 0;
  const double longest = v.cwiseAbs().maxCoeff(&axis);
  if (!(longest > 0)) return 0;
  const auto cell = [&](int other) {
    const double t = 0.5 + 0.5 * v[other] / longest;
    return std::clamp(static_cast<int>(t * kDirectionsPerEdge), 0, kDirectionsPerEdge - 1);
  };
  const int face = 2 * axis + (v[axis] < 0 ? 1 : 0);
  return static_cast<std::size_t>((face * kDirectionsPerEdge + cell((axis + 1) % 3)) * kDirectionsPerEdge +
                                  cell((axis + 2) % 3));
}

std::vector<Eigen::Vector3d> outermost(const std::vector<Eigen::Vector3d>& points,
                                       const Eigen::Vector3d& middle) {
  constexpr std::size_t kDirections = std::size_t{6} * kDirectionsPerEdge * kDirectionsPerEdge;
  std::vector<std::size_t> farthest(kDirections, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t& best = farthest[direction_of(points[i] - middle)];
    if (best == points.size() || (points[i] - middle).squaredNorm() > (points[best] - middle).squaredNorm())
      best = i;
  }
  std::vector<Eigen::Vector3d> kept;
  for (const std::size_t i : farthest) {
    if (i < points.size()) kept.push_back(points[i]);
  }
  return kept;
}

// Qhull's context with its memory.
class Qhull {
 public:
  Qhull() : errors_(std::fopen("/dev/null", "w")) { qh_zero(&context_, errors_); }
  ~Qhull() {
    qh_freeqhull(&context_, !qh_ALL);
    int remaining = 0;
    int total = 0;
    qh_memfreeshort(&context_, &remaining, &total);
    if (errors_ != nullptr) std::fclose(errors_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  bool run(std::vector<coordT>& coordinates) {
    char command[] = "qhull Qt Pp";  // triangulated, no warnings
    return qh_new_qhull(&context_, 3, static_cast<int>(coordinates.size() / 3), coordinates.data(), False,
                        command, nullptr, errors_) == 0;
  }
  qhT* context() { return &context_; }

 private:
  std::FILE* errors_;
  qhT context_{};
};

void link_neighbours(ConvexHull& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::uint32_t, std::uint32_t>> sides;
  for (std::uint32_t f = 0; f < hull.facets.size(); ++f) {
    ConvexHull::Facet& facet = hull.facets[f];
    facet.across.fill(ConvexHull::kNoFacet);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = facet.corners.at(k);
      const std::uint32_t b = facet.corners.at((k + 1) % 3);
      const auto twin = sides.find({b, a});
      if (twin == sides.end()) {
        sides[{a, b}] = {f, k};
        continue;
      }
      facet.across.at(k) = twin->second.first;
      hull.facets[twin->second.first].across.at(twin->second.second) = f;
      sides.erase(twin);
    }
  }
}

}  // namespace

std::optional<ConvexHull> convex_hull(const std::vector<Eigen::Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  if (points.size() < 4 || !(box.diagonal().norm() > 0)) return std::nullopt;
  const Eigen::Vector3d middle = box.center();
  const double scale = box.diagonal().norm();
  const std::vector<Eigen::Vector3d> few =
      points.size() > kMaxHullPoints ? outermost(points, middle) : points;
  std::vector<coordT> coordinates;
  for (const Eigen::Vector3d& p : few) {
    for (int k = 0; k < 3; ++k) coordinates.push_back((p[k] - middle[k]) / scale);
  }

  Qhull qhull;
  if (!qhull.run(coordinates)) return std::nullopt;
  qhT* qh = qhull.context();  // the name that Qhull's macros expect
  ConvexHull hull;
  std::map<int, std::uint32_t> place;
  facetT* facet = nullptr;
  FORALLfacets {
    ConvexHull::Facet out;
    out.normal = Eigen::Vector3d(facet->normal[0], facet->normal[1], facet->normal[2]).normalized();
    std::size_t k = 0;
    vertexT* vertex = nullptr;
    vertexT** vertexp = nullptr;
    FOREACHvertex_(facet->vertices) {
      if (k == 3) break;
      const int point = qh_pointid(qh, vertex->point);
      const auto [entry, added] = place.emplace(point, static_cast<std::uint32_t>(hull.vertices.size()));
      if (added) hull.vertices.push_back(few[static_cast<std::size_t>(point)]);
      out.corners.at(k++) = entry->second;
    }
    if (k != 3) return std::nullopt;
    // Qhull lists the vertices of a simplicial facet so that its orientation flag gives the turn.
    if ((facet->toporient ^ qh_ORIENTclock) != 0) std::swap(out.corners[1], out.corners[2]);
    hull.facets.push_back(out);
  }
  link_neighbours(hull);
  // Thinner than rounding lets one tell: flat.
  constexpr double kFlat = 1e-6;
  if (!(solid_of(hull).volume > kFlat * scale * scale * scale)) return std::nullopt;
  return hull;
}

Solid solid_of(const ConvexHull& hull) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : hull.vertices) middle += p;
  middle /= static_cast<double>(std::max<std::size_t>(1, hull.vertices.size()));
  double six_volumes = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const ConvexHull::Facet& facet : hull.facets) {
    const Eigen::Vector3d a = hull.vertices[facet.corners[0]] - middle;
    const Eigen::Vector3d b = hull.vertices[facet.corners[1]] - middle;
    const Eigen::Vector3d c = hull.vertices[facet.corners[2]] - middle;
    const double v = a.dot(b.cross(c));
    six_volumes += v;
    moment += v * (a + b + c) / 4;
  }
  return {six_volumes / 6, six_volumes > 0 ? Eigen::Vector3d(middle + moment / six_volumes) : middle};
}

}  // namespace sextant
