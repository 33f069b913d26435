// SPDX-License-Identifier: Apache-2.0
// A compiled object in memory: viewpoint bins with visual and depth parts (Davies 2015, ch. 3), and where
// it came from. Coefficients are in tangent units (focal length 1) and metres, so one model serves any
// calibrated camera.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/geometry/rigid_transform.h"
#include "runtime/model/confidence_model.h"

namespace sextant {

/// What a sensor makes of a part in synthesised scenes (offline/learn/part_statistics.h). A part is "found"
/// where the feature lies within kFoundSigmas * sqrt(spread) of where it is expected.
struct PartStatistics {
  float spread = 0;           ///< variance of the found ones, noise of the sensor included; 0: not measured
  float found = 0.75F;        ///< how often it is found on the object, 0..1 exclusive
  float background = 0.125F;  ///< how often it is found by chance at a wrong pose, 0..1 exclusive
  /// The length of edge or the area that it stands for, in units of the model's mean. Bins have equal numbers
  /// of parts however much of the object they show; this makes their evidence comparable.
  float weight = 1;
};
inline constexpr double kFoundSigmas = 2.5;

/// A part that expects an edge of one direction near a position (eqs. 3.3-3.5).
/// Expected pixel: (x, y) + focal / z * (c[0] + c[1] rx + c[2] ry + c[3] rz), rows for u and v.
struct VisualPart {
  std::uint8_t kind = 0;     ///< edge direction, 0..kFeatureKinds-1
  std::array<float, 4> u{};  ///< a, c, e, g: metres at unit distance scale (tangent * metre)
  std::array<float, 4> v{};  ///< b, d, f, h
  float variance = 0;        ///< (tangent * metre)^2
  float radius = 0;          ///< receptive field r, tangent * metre
  PartStatistics seen;       ///< spread per axis, (tangent * metre)^2
};

/// What a depth part expects to see.
enum class DepthRole : std::uint8_t {
  kObject,  ///< the object, from every pose of the bin
  kRim,     ///< the object from most poses of the bin, else what is behind it
  /// The table beside or behind the object: says where the object ends, and holds it upright and at its
  /// height.
  kTable,
};

/// A part that expects a depth at a fixed position (eqs. 3.6-3.8).
/// Pixel: (x, y) + focal / z * (px, py); expected ray depth: z + d[0] + d[1] rx + d[2] ry + d[3] rz.
struct DepthPart {
  float px = 0, py = 0;      ///< tangent * metre
  std::array<float, 4> d{};  ///< i, j, k, l: metres (per radian)
  float variance = 0;        ///< m^2
  float radius = 0;          ///< r, metres
  float missing = 0;         ///< d0: difference assumed where depth is missing, metres, <= radius
  PartStatistics seen;       ///< spread in m^2
  DepthRole role = DepthRole::kObject;
};

/// Half-open box of rotations in whole degrees: lo <= angle < hi for rx, ry, rz.
struct RotationBox {
  std::array<int, 3> lo_deg{};
  std::array<int, 3> hi_deg{};
};

/// One viewpoint bin and its model.
struct ViewpointBin {
  RotationBox box;
  std::vector<VisualPart> visual;
  std::vector<DepthPart> depth;
  /// 2D box of the object around its projected centre, in tangent * metre: min u, min v, max u, max v.
  std::array<float, 4> extent{};
};

/// Triangles of the object for overlays and refinement: a simplified copy of the mesh, in the object frame.
struct ModelMesh {
  std::vector<Eigen::Vector3f> vertices;  ///< metres
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A point of an edge of the object's print (or of any other change of colour that is no crease), object
/// frame.
struct SurfaceMark {
  Eigen::Vector3f point{0, 0, 0};      ///< metres
  Eigen::Vector3f direction{1, 0, 0};  ///< unit, along the edge
  Eigen::Vector3f normal{0, 0, 1};     ///< unit, of the surface, outwards
};

/// What makes a model reproducible, and who it is.
struct ModelProvenance {
  std::string program_version;  ///< "sextant 0.1.0"
  std::string mesh_name;        ///< file name of the mesh, no folder
  std::uint64_t mesh_hash = 0;  ///< XXH3 of the mesh file's bytes
  std::uint64_t seed = 0;
  std::string parameters;  ///< the learning parameters as one line of YAML flow mapping
};

/// A compiled object.
struct ObjectModel {
  std::string name;                  ///< e.g. "mug": the file name's stem
  int object_id = 1;                 ///< BOP object id
  int symmetry_deg = 360;            ///< 0 rotational, 90, 180 or 360: with the object's print
  int geometric_symmetry_deg = 360;  ///< of the shape alone, for evaluation
  double bounding_radius_m = 0;      ///< of the bounding sphere around the object frame's origin
  double centre_height_m = 0;        ///< of the object frame's origin above the table when it stands
  /// Object frame (origin in the bounding sphere's centre, z up in the resting pose) from the mesh's own
  /// frame in metres: p_in_object = object_from_mesh * p_in_mesh.
  RigidTransform object_from_mesh = RigidTransform::Identity();
  std::vector<ViewpointBin> bins;
  ModelMesh mesh;
  std::vector<SurfaceMark> marks;  ///< for the refinement; may be empty
  ConfidenceModel confidence;
  ModelProvenance provenance;
};

/// Kinds of visual features: eight edge directions of 22.5 deg each, undirected (Davies 2015, sec. 5.1).
inline constexpr int kFeatureKinds = 8;

}  // namespace sextant
