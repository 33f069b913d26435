// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/simplify.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <tuple>

#include "offline/mesh/normals.h"
#include "offline/mesh/surface_index.h"

namespace sextant {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<std::uint32_t, 3>;

// Sum of squared distances to planes, weighted by area: x^T a x - 2 b^T x + c.
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;

  void add_plane(const Vector3d& unit_normal, const Vector3d& point, double weight) {
    const double d = unit_normal.dot(point);
    a += weight * unit_normal * unit_normal.transpose();
    b += weight * d * unit_normal;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  double at(const Vector3d& x) const { return std::max(0.0, x.dot(a * x) - 2 * b.dot(x) + c); }
};

struct Collapse {
  double cost;
  std::uint32_t keep, drop;
  std::uint32_t age_keep, age_drop;  // stale if a vertex has changed since
};
struct LaterCollapse {
  bool operator()(const Collapse& a, const Collapse& b) const {
    return std::tie(a.cost, a.keep, a.drop) > std::tie(b.cost, b.keep, b.drop);
  }
};

class Simplifier {
 public:
  explicit Simplifier(const Mesh& mesh) {
    const std::vector<std::uint32_t> welded = welded_indices(mesh.vertices);
    std::vector<std::uint32_t> place(mesh.vertices.size(), ~std::uint32_t{0});
    for (const MeshPart& part : mesh.parts) {
      for (const Triangle& t : part.triangles) {
        Triangle to{};
        for (std::size_t k = 0; k < 3; ++k) {
          std::uint32_t& p = place[welded[t.at(k)]];
          if (p == ~std::uint32_t{0}) {
            p = static_cast<std::uint32_t>(position_.size());
            position_.push_back(mesh.vertices[t.at(k)].cast<double>());
          }
          to.at(k) = p;
        }
        if (to[0] != to[1] && to[1] != to[2] && to[2] != to[0]) triangle_.push_back(to);
      }
    }
    alive_.assign(triangle_.size(), true);
    alive_count_ = triangle_.size();
    around_.resize(position_.size());
    age_.assign(position_.size(), 0);
    quadric_.resize(position_.size());
    for (std::uint32_t t = 0; t < triangle_.size(); ++t) {
      for (const std::uint32_t v : triangle_[t]) around_[v].push_back(t);
    }
  }

  void collapse_until(std::size_t max_triangles) {
    if (alive_count_ <= max_triangles) return;
    start_quadrics();
    for (std::uint32_t v = 0; v < position_.size(); ++v) {
      for (const std::uint32_t w : neighbours(v)) {
        if (v < w) consider(v, w);
      }
    }
    while (alive_count_ > max_triangles && !queue_.empty()) {
      const Collapse next = queue_.top();
      queue_.pop();
      if (next.age_keep != age_[next.keep] || next.age_drop != age_[next.drop]) continue;
      const Vector3d target = best_position(next.keep, next.drop);
      if (pinches(next.keep, next.drop) || folds(next.keep, next.drop, target)) continue;
      perform(next.keep, next.drop, target);
    }
  }

  // Merges all vertices of a grid cell into their mean; halves the number of cells until few enough are left.
  void cluster_until(std::size_t max_triangles) {
    if (alive_count_ <= max_triangles) return;
    Eigen::AlignedBox3d box;
    for (const Triangle& t : living()) {
      for (const std::uint32_t v : t) box.extend(position_[v]);
    }
    const double size = box.diagonal().norm();
    double fine = size * 1e-4;
    double coarse = size * 2;
    for (int i = 0; i < 24; ++i) {
      const double middle = std::sqrt(fine * coarse);
      (clustered(box.min(), middle).triangles.size() > max_triangles ? fine : coarse) = middle;
    }
    result_ = clustered(box.min(), coarse);
  }

  ModelMesh result() {
    if (!result_.triangles.empty() || alive_count_ == 0) return result_;
    std::vector<std::uint32_t> place(position_.size(), ~std::uint32_t{0});
    for (Triangle t : living()) {
      for (std::uint32_t& v : t) {
        if (place[v] == ~std::uint32_t{0}) {
          place[v] = static_cast<std::uint32_t>(result_.vertices.size());
          result_.vertices.push_back(position_[v].cast<float>());
        }
        v = place[v];
      }
      result_.triangles.push_back(t);
    }
    return result_;
  }

 private:
  std::vector<Triangle> living() const {
    std::vector<Triangle> all;
    for (std::size_t t = 0; t < triangle_.size(); ++t) {
      if (alive_[t]) all.push_back(triangle_[t]);
    }
    return all;
  }

  Vector3d area_vector(const Triangle& t) const {
    return 0.5 * (position_[t[1]] - position_[t[0]]).cross(position_[t[2]] - position_[t[0]]);
  }

  std::vector<std::uint32_t> neighbours(std::uint32_t v) const {
    std::vector<std::uint32_t> all;
    for (const std::uint32_t t : around_[v]) {
      for (const std::uint32_t w : triangle_[t]) {
        if (w != v) all.push_back(w);
      }
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  std::size_t triangles_on(std::uint32_t v, std::uint32_t w) const {
    return static_cast<std::size_t>(std::count_if(around_[v].begin(), around_[v].end(), [&](std::uint32_t t) {
      return std::find(triangle_[t].begin(), triangle_[t].end(), w) != triangle_[t].end();
    }));
  }

  void start_quadrics() {
    double mean_area = 0;
    for (const Triangle& t : triangle_)
      mean_area += area_vector(t).norm() / static_cast<double>(triangle_.size());
    for (const Triangle& t : triangle_) {
      const Vector3d vector = area_vector(t);
      const double area = vector.norm();
      if (!(area > 0)) continue;
      // Half by area, half by count: by area alone, a spike of small triangles would cost nothing.
      const double weight = (area + mean_area) / 6;
      for (const std::uint32_t v : t) quadric_[v].add_plane(vector / area, position_[t[0]], weight);
      // A border edge is held by a plane at right angles to its triangle.
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = t.at(k);
        const std::uint32_t w = t.at((k + 1) % 3);
        if (around_[v].size() > kMaxAround || triangles_on(v, w) != 1) continue;
        const Vector3d edge = position_[w] - position_[v];
        const Vector3d wall = edge.cross(vector).stableNormalized();
        for (const std::uint32_t end : {v, w})
          quadric_[end].add_plane(wall, position_[v], edge.squaredNorm());
      }
    }
  }

  // Where the joint quadric is least, if it says so clearly and close by; else the best of ends and middle.
  Vector3d best_position(std::uint32_t v, std::uint32_t w) const {
    Quadric q = quadric_[v];
    q += quadric_[w];
    const Vector3d middle = 0.5 * (position_[v] + position_[w]);
    // Pulled gently to the middle: along a flat or straight piece the least is not a single point.
    const double pull = 1e-3 * q.a.trace();
    const Vector3d least = (q.a + pull * Eigen::Matrix3d::Identity()).ldlt().solve(q.b + pull * middle);
    Vector3d best = middle;
    for (const Vector3d& candidate : {position_[v], position_[w], least}) {
      const bool close = (candidate - middle).norm() <= 2 * (position_[w] - position_[v]).norm();
      if (candidate.allFinite() && close && q.at(candidate) < q.at(best)) best = candidate;
    }
    return best;
  }

  void consider(std::uint32_t v, std::uint32_t w) {
    if (around_[v].size() > kMaxAround || around_[w].size() > kMaxAround) return;
    Quadric q = quadric_[v];
    q += quadric_[w];
    const Vector3d target = best_position(v, w);
    // Between equal costs (flat pieces), short edges first.
    const double cost = q.at(target) + 1e-9 * (position_[v] - position_[w]).squaredNorm() * q.a.trace();
    queue_.push({cost, std::min(v, w), std::max(v, w), age_[std::min(v, w)], age_[std::max(v, w)]});
  }

  // The link condition: common neighbours must be those across from the edge, one per triangle on it.
  bool pinches(std::uint32_t v, std::uint32_t w) const {
    const std::vector<std::uint32_t> a = neighbours(v);
    const std::vector<std::uint32_t> b = neighbours(w);
    std::vector<std::uint32_t> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    return common.size() != triangles_on(v, w) || common.size() > 2 || a.size() + b.size() > kMaxAround;
  }

  bool folds(std::uint32_t v, std::uint32_t w, const Vector3d& target) const {
    for (const std::uint32_t from : {v, w}) {
      for (const std::uint32_t t : around_[from]) {
        Triangle corners = triangle_[t];
        const std::uint32_t other = from == v ? w : v;
        if (std::find(corners.begin(), corners.end(), other) != corners.end()) continue;
        const Vector3d before = area_vector(corners);
        std::array<Vector3d, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
          p.at(k) = corners.at(k) == from ? target : position_[corners.at(k)];
        const Vector3d after = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]);
        if (before.dot(after) < 0.2 * before.norm() * after.norm()) return true;
      }
    }
    return false;
  }

  void perform(std::uint32_t keep, std::uint32_t drop, const Vector3d& target) {
    position_[keep] = target;
    quadric_[keep] += quadric_[drop];
    for (const std::uint32_t t : around_[drop]) {
      Triangle& corners = triangle_[t];
      if (std::find(corners.begin(), corners.end(), keep) != corners.end()) {
        alive_[t] = false;
        --alive_count_;
        for (const std::uint32_t v : corners) {
          if (v != drop) std::erase(around_[v], t);
        }
      } else {
        std::replace(corners.begin(), corners.end(), drop, keep);
        around_[keep].push_back(t);
      }
    }
    around_[drop].clear();
    ++age_[drop];
    ++age_[keep];
    for (const std::uint32_t w : neighbours(keep)) consider(keep, w);
  }

  ModelMesh clustered(const Vector3d& corner, double cell) const {
    using Cell = std::array<std::int64_t, 3>;
    struct Mean {
      Vector3d sum = Vector3d::Zero();
      double count = 0;
      std::uint32_t index = 0;
    };
    const auto cell_of = [&](std::uint32_t v) {
      const Vector3d c = ((position_[v] - corner) / cell).array().floor();
      return Cell{static_cast<std::int64_t>(c.x()), static_cast<std::int64_t>(c.y()),
                  static_cast<std::int64_t>(c.z())};
    };
    std::map<Cell, Mean> means;
    const std::vector<Triangle> all = living();
    for (const Triangle& t : all) {
      for (const std::uint32_t v : t) {
        Mean& mean = means[cell_of(v)];
        mean.sum += position_[v];
        mean.count += 1;
      }
    }
    ModelMesh out;
    for (auto& [key, mean] : means) {
      mean.index = static_cast<std::uint32_t>(out.vertices.size());
      out.vertices.push_back((mean.sum / mean.count).cast<float>());
    }
    for (const Triangle& t : all) {
      Triangle to{means[cell_of(t[0])].index, means[cell_of(t[1])].index, means[cell_of(t[2])].index};
      if (to[0] == to[1] || to[1] == to[2] || to[2] == to[0]) continue;
      std::rotate(to.begin(), std::min_element(to.begin(), to.end()), to.end());
      out.triangles.push_back(to);
    }
    std::sort(out.triangles.begin(), out.triangles.end());
    out.triangles.erase(std::unique(out.triangles.begin(), out.triangles.end()), out.triangles.end());
    return out;
  }

  static constexpr std::size_t kMaxAround =
      200;  // vertices with more triangles stay: cost would be quadratic

  std::vector<Vector3d> position_;
  std::vector<Triangle> triangle_;
  std::vector<bool> alive_;
  std::size_t alive_count_ = 0;
  std::vector<std::vector<std::uint32_t>> around_;  // living triangles at each vertex
  std::vector<std::uint32_t> age_;
  std::vector<Quadric> quadric_;
  std::priority_queue<Collapse, std::vector<Collapse>, LaterCollapse> queue_;
  ModelMesh result_;
};

}  // namespace

ModelMesh simplified(const Mesh& mesh, std::size_t max_triangles) {
  const std::size_t most = std::max<std::size_t>(4, max_triangles);
  Simplifier simplifier(mesh);
  simplifier.collapse_until(most);
  simplifier.cluster_until(most);
  return simplifier.result();
}

double surface_distance_m(const Mesh& mesh, const ModelMesh& other, std::size_t samples) {
  const TriangleList list = triangle_list(mesh);
  const SurfaceIndex first(list.vertices, list.triangles);
  const SurfaceIndex second(other.vertices, other.triangles);
  double most = 0;
  const auto measure = [&](const SurfaceIndex& from, const SurfaceIndex& to) {
    for (const SurfacePoint& p : spread_points(from.vertices(), from.triangles(), samples)) {
      most = std::max(most, to.distance(p.position));
    }
    for (const Eigen::Vector3f& p : from.vertices()) most = std::max(most, to.distance(p.cast<double>()));
  };
  measure(first, second);
  measure(second, first);
  return most;
}

ModelMesh simplified_within(const Mesh& mesh, double tolerance_m, std::size_t max_triangles) {
  constexpr std::size_t kCoarsest = 200;
  std::vector<std::size_t> sizes;
  for (std::size_t n = max_triangles; n >= kCoarsest; n /= 2) sizes.push_back(n);
  // From the coarsest on: the first that fits wins, the finest needs no check.
  for (std::size_t i = sizes.size(); i-- > 1;) {
    ModelMesh candidate = simplified(mesh, sizes[i]);
    if (surface_distance_m(mesh, candidate) <= tolerance_m) return candidate;
  }
  return simplified(mesh, max_triangles);
}

}  // namespace sextant
