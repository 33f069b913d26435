// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/contour_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace sextant {
namespace {

constexpr float kCreaseCosine = 0.85F;  // 32 deg: simplified smooth surfaces bend less from face to face
/// A point this far (metres) behind the surface that is seen at its pixel is hidden.
constexpr double kBehind = 0.004;
/// A mark seen more flatly than this (cosine) shows no reliable edge.
constexpr double kFlatMark = 0.25;

/// Whether nothing of the object hides a point. Around it: on a silhouette the point's own pixel may show
/// the surface in front of which it ends.
bool is_visible(const Eigen::Vector3d& point, const Eigen::Vector2d& pixel, const DepthRaster& raster) {
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  const double limit = 1 / (point.z() - kBehind);
  if (raster.inverse_depth(x, y) <= limit) return true;
  return raster.inverse_depth(x - 1, y) <= limit && raster.inverse_depth(x + 1, y) <= limit &&
         raster.inverse_depth(x, y - 1) <= limit && raster.inverse_depth(x, y + 1) <= limit;
}

bool in_image(const Eigen::Vector2d& pixel, const PinholeCamera& camera) {
  return pixel.x() > 1 && pixel.y() > 1 && pixel.x() < camera.width - 2 && pixel.y() < camera.height - 2;
}

}  // namespace

ContourEdges::ContourEdges(const ObjectModel& model) : mesh_(&model.mesh), marks_(&model.marks) {
  const auto& vertices = mesh_->vertices;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> known;
  for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
    const auto& corner = mesh_->triangles[t];
    const Eigen::Vector3f n =
        (vertices[corner[1]] - vertices[corner[0]]).cross(vertices[corner[2]] - vertices[corner[0]]);
    const float length = n.norm();
    face_normals_.emplace_back(length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f::Zero());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = corner[k];
      const std::uint32_t b = corner[(k + 1) % 3];
      const auto [at, fresh] = known.try_emplace({std::min(a, b), std::max(a, b)}, edges_.size());
      if (fresh) {
        edges_.push_back({a, b, static_cast<std::int32_t>(t), -1, false, false});
      } else if (edges_[at->second].right < 0) {
        MeshEdge& edge = edges_[at->second];
        edge.right = static_cast<std::int32_t>(t);
        edge.flipped = edge.a == a;
      }
    }
  }
  for (MeshEdge& edge : edges_) {
    if (edge.right < 0) continue;
    const float cosine = face_normals_[static_cast<std::size_t>(edge.left)].dot(
        face_normals_[static_cast<std::size_t>(edge.right)]);
    edge.crease = (edge.flipped ? -cosine : cosine) < kCreaseCosine;
  }
}

void ContourEdges::add_line(const MeshEdge& edge, EdgeOrigin origin, const PinholeCamera& camera,
                            const DepthRaster& raster, double spacing_px,
                            std::vector<EdgeSample>& out) const {
  const Eigen::Vector3d a = raster.vertices_in_camera()[edge.a].cast<double>();
  const Eigen::Vector3d b = raster.vertices_in_camera()[edge.b].cast<double>();
  if (a.z() < 0.05 || b.z() < 0.05) return;
  const Eigen::Vector2d pa = camera.project(a);
  const Eigen::Vector2d pb = camera.project(b);
  const Eigen::Vector2d along = pb - pa;
  const double length = along.norm();
  // Short pieces of a curved silhouette are taken as often as their length deserves.
  const int count = length >= spacing_px ? static_cast<int>(length / spacing_px) : (length >= 0.3 ? 1 : 0);
  for (int i = 0; i < count; ++i) {
    const double s = (i + 0.5) / count;
    // Perspective: the middle in the image is not the middle in space.
    const double t = s * a.z() / (s * a.z() + (1 - s) * b.z());
    EdgeSample sample;
    sample.point = a + t * (b - a);
    sample.pixel = pa + s * along;
    if (!in_image(sample.pixel, camera) || !is_visible(sample.point, sample.pixel, raster)) continue;
    sample.normal = Eigen::Vector2d(-along.y(), along.x()) / length;
    sample.spacing_px = length / count;
    sample.origin = origin;
    out.push_back(sample);
  }
}

void ContourEdges::sample(const RigidTransform& camera_from_object, const PinholeCamera& camera,
                          const DepthRaster& raster, double spacing_px, std::vector<EdgeSample>& out) {
  out.clear();
  const Eigen::Vector3f eye =
      (camera_from_object.linear().transpose() * -camera_from_object.translation()).cast<float>();
  facing_.resize(face_normals_.size());
  for (std::size_t t = 0; t < face_normals_.size(); ++t) {
    facing_[t] = face_normals_[t].dot(eye - mesh_->vertices[mesh_->triangles[t][0]]) > 0 ? 1 : -1;
  }
  for (const MeshEdge& edge : edges_) {
    bool silhouette = edge.right < 0;
    if (!silhouette) {
      const int right = facing_[static_cast<std::size_t>(edge.right)] * (edge.flipped ? -1 : 1);
      silhouette = facing_[static_cast<std::size_t>(edge.left)] != right;
    }
    if (silhouette) {
      add_line(edge, EdgeOrigin::kSilhouette, camera, raster, spacing_px, out);
    } else if (edge.crease) {
      add_line(edge, EdgeOrigin::kCrease, camera, raster, spacing_px, out);
    }
  }
  for (const SurfaceMark& mark : *marks_) {
    const Eigen::Vector3d normal = camera_from_object.linear() * mark.normal.cast<double>();
    EdgeSample sample;
    sample.point = camera_from_object * mark.point.cast<double>();
    if (sample.point.z() < 0.05 || -normal.dot(sample.point) < kFlatMark * sample.point.norm()) continue;
    sample.pixel = camera.project(sample.point);
    if (!in_image(sample.pixel, camera) || !is_visible(sample.point, sample.pixel, raster)) continue;
    const Eigen::Vector3d d = camera_from_object.linear() * mark.direction.cast<double>();
    // Image direction of a line along d: derivative of the projection.
    const Eigen::Vector2d along(d.x() * sample.point.z() - sample.point.x() * d.z(),
                                d.y() * sample.point.z() - sample.point.y() * d.z());
    const double length = along.norm();
    if (length < 1e-6) continue;
    sample.normal = Eigen::Vector2d(-along.y(), along.x()) / length;
    sample.spacing_px = spacing_px;
    sample.origin = EdgeOrigin::kMark;
    out.push_back(sample);
  }
}

}  // namespace sextant
