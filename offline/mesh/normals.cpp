// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/normals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sextant {
namespace {

// Around a vertex with more facets than this, a facet keeps its own normal: the cost would be quadratic.
constexpr std::size_t kMaxFacetsAround = 256;

bool usable(const Eigen::Vector3f& normal) { return normal.allFinite() && normal.squaredNorm() > 1e-12F; }

struct Facet {
  Eigen::Vector3f normal;        // unit, or zero for a sliver
  std::array<float, 3> angle{};  // at each corner, radians
};

Facet facet_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  std::array<Eigen::Vector3d, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p.at(k) = mesh.vertices[t.at(k)].cast<double>();
  Facet facet;
  facet.normal = (p[1] - p[0]).cross(p[2] - p[0]).stableNormalized().cast<float>();
  if (!facet.normal.allFinite()) facet.normal.setZero();
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = p.at((k + 1) % 3) - p.at(k);
    const Eigen::Vector3d b = p.at((k + 2) % 3) - p.at(k);
    facet.angle.at(k) = static_cast<float>(std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return facet;
}

// Copies of one vertex of the file with different normals, as a chain.
struct Copy {
  Eigen::Vector3f normal;
  std::uint32_t vertex;
  std::uint32_t next;
};
constexpr std::uint32_t kNone = ~std::uint32_t{0};

}  // namespace

std::vector<std::uint32_t> welded_indices(const std::vector<Eigen::Vector3f>& vertices) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Eigen::Vector3f& p = vertices[a];
    const Eigen::Vector3f& q = vertices[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

void share_equal_vertices(Mesh& mesh) {
  using Key = std::array<float, 11>;
  const auto key = [&](std::uint32_t i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    const Eigen::Vector3f& n = mesh.normals[i];
    const Eigen::Vector3f& c = mesh.colours[i];
    const Eigen::Vector2f& t = mesh.uvs[i];
    return Key{p[0], p[1], p[2], n[0], n[1], n[2], c[0], c[1], c[2], t[0], t[1]};
  };
  std::vector<std::uint32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Key first = key(a);
    const Key second = key(b);
    return first != second ? first < second : a < b;
  });
  std::vector<std::uint32_t> same(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    same[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? same[order[i - 1]] : order[i];
  }
  std::vector<std::uint32_t> place(order.size());
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    if (same[i] != i) continue;
    place[i] = kept;
    mesh.vertices[kept] = Eigen::Vector3f(mesh.vertices[i]);
    mesh.normals[kept] = Eigen::Vector3f(mesh.normals[i]);
    mesh.colours[kept] = Eigen::Vector3f(mesh.colours[i]);
    mesh.uvs[kept] = Eigen::Vector2f(mesh.uvs[i]);
    ++kept;
  }
  for (MeshPart& part : mesh.parts) {
    for (auto& t : part.triangles) {
      for (std::uint32_t& v : t) v = place[same[v]];
    }
  }
  mesh.vertices.resize(kept);
  mesh.normals.resize(kept);
  mesh.colours.resize(kept);
  mesh.uvs.resize(kept);
}

void complete_normals(Mesh& mesh) {
  const bool complete = std::all_of(mesh.normals.begin(), mesh.normals.end(), usable);
  for (Eigen::Vector3f& n : mesh.normals) {
    if (usable(n)) n.normalize();
  }
  if (complete) return;

  const std::vector<std::uint32_t> welded = welded_indices(mesh.vertices);
  std::vector<Facet> facets;
  std::vector<std::array<std::uint32_t, 3>> corners;
  for (const MeshPart& part : mesh.parts) {
    for (const auto& t : part.triangles) {
      facets.push_back(facet_of(mesh, t));
      corners.push_back({welded[t[0]], welded[t[1]], welded[t[2]]});
    }
  }
  // around[start[v] .. start[v + 1]): 3 * facet + corner for the facets at the position v.
  std::vector<std::uint32_t> start(mesh.vertices.size() + 1, 0);
  for (const auto& t : corners) {
    for (const std::uint32_t v : t) ++start[v + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> around(3 * corners.size());
  std::vector<std::uint32_t> filled(start.begin(), start.end() - 1);
  for (std::uint32_t f = 0; f < corners.size(); ++f) {
    for (std::uint32_t k = 0; k < 3; ++k) around[filled[corners[f].at(k)]++] = 3 * f + k;
  }

  const auto smooth_limit = static_cast<float>(std::cos(kCreaseDeg * std::numbers::pi / 180));
  const auto corner_normal = [&](std::uint32_t facet, std::uint32_t position) {
    const Eigen::Vector3f own = facets[facet].normal;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    if (start[position + 1] - start[position] <= kMaxFacetsAround) {
      for (std::uint32_t i = start[position]; i < start[position + 1]; ++i) {
        const Facet& other = facets[around[i] / 3];
        if (own.isZero() || other.normal.dot(own) >= smooth_limit)
          sum += other.normal * other.angle.at(around[i] % 3);
      }
    }
    if (!usable(sum)) sum = own;
    if (!usable(sum)) sum = Eigen::Vector3f::UnitZ();
    return Eigen::Vector3f(sum.normalized());
  };

  std::vector<std::uint32_t> chain(mesh.vertices.size(), kNone);
  std::vector<Copy> copies;
  std::uint32_t facet = 0;
  const std::size_t from_file = mesh.vertices.size();
  std::vector<bool> missing(from_file);
  for (std::size_t i = 0; i < from_file; ++i) missing[i] = !usable(mesh.normals[i]);
  for (MeshPart& part : mesh.parts) {
    for (auto& t : part.triangles) {
      for (std::uint32_t& corner : t) {
        if (!missing[corner]) continue;
        const Eigen::Vector3f normal = corner_normal(facet, welded[corner]);
        std::uint32_t c = chain[corner];
        while (c != kNone && !copies[c].normal.isApprox(normal, 1e-4F)) c = copies[c].next;
        if (c == kNone) {
          const bool first = chain[corner] == kNone;
          const std::uint32_t vertex = first ? corner : static_cast<std::uint32_t>(mesh.vertices.size());
          if (first) {
            mesh.normals[corner] = normal;
          } else {
            mesh.vertices.push_back(Eigen::Vector3f(mesh.vertices[corner]));
            mesh.normals.push_back(normal);
            mesh.colours.push_back(Eigen::Vector3f(mesh.colours[corner]));
            mesh.uvs.push_back(Eigen::Vector2f(mesh.uvs[corner]));
          }
          copies.push_back({normal, vertex, chain[corner]});
          c = static_cast<std::uint32_t>(copies.size()) - 1;
          chain[corner] = c;
        }
        corner = copies[c].vertex;
      }
      ++facet;
    }
  }
  // A vertex that only slivers without direction use.
  for (Eigen::Vector3f& n : mesh.normals) {
    if (!usable(n)) n = Eigen::Vector3f::UnitZ();
  }
}

}  // namespace sextant
