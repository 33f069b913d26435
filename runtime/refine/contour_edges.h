// SPDX-License-Identifier: Apache-2.0
// Where a rigid object shows edges in an image: its silhouette and creases, found from the mesh and the view
// (Markosian et al. 1997, "Real-time nonphotorealistic rendering"), and the marks of its print, which the
// model carries. Each becomes a row of points with the direction in which the image's edge may have moved.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "runtime/geometry/camera_model.h"
#include "runtime/geometry/rigid_transform.h"
#include "runtime/model/object_model.h"
#include "runtime/refine/depth_raster.h"

namespace sextant {

/// What makes an edge.
enum class EdgeOrigin : std::uint8_t {
  kSilhouette,  ///< one side of the mesh's edge faces the camera, the other one does not
  kCrease,      ///< both sides do, at an angle
  kMark,        ///< print
};

/// A point of an edge that the camera should see.
struct EdgeSample {
  Eigen::Vector3d point{0, 0, 0};  ///< camera frame, metres
  Eigen::Vector2d pixel{0, 0};     ///< its image
  Eigen::Vector2d normal{1, 0};    ///< unit, perpendicular to the edge in the image
  double spacing_px = 1;           ///< length of edge that it stands for
  EdgeOrigin origin = EdgeOrigin::kSilhouette;
};

/// The edges of one model's mesh, prepared once.
class ContourEdges {
 public:
  explicit ContourEdges(const ObjectModel& model);

  /// Visible points about every `spacing_px` pixels along silhouette and creases, and the visible marks.
  /// `raster`: the mesh drawn at the same pose. Points outside the image are left out.
  void sample(const RigidTransform& camera_from_object, const PinholeCamera& camera,
              const DepthRaster& raster, double spacing_px, std::vector<EdgeSample>& out);

  /// Unit normal of each triangle, object frame; 0 for a degenerate one.
  const std::vector<Eigen::Vector3f>& face_normals() const { return face_normals_; }

 private:
  struct MeshEdge {
    std::uint32_t a = 0, b = 0;        ///< vertices
    std::int32_t left = 0, right = 0;  ///< triangles; right = -1: the mesh ends here
    bool flipped = false;              ///< the triangles are wound differently
    bool crease = false;
  };
  void add_line(const MeshEdge& edge, EdgeOrigin origin, const PinholeCamera& camera,
                const DepthRaster& raster, double spacing_px, std::vector<EdgeSample>& out) const;

  const ModelMesh* mesh_;
  const std::vector<SurfaceMark>* marks_;
  std::vector<Eigen::Vector3f> face_normals_;
  std::vector<MeshEdge> edges_;
  std::vector<signed char> facing_;  ///< scratch of sample()
};

}  // namespace sextant
