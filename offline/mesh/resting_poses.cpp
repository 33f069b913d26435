// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/resting_poses.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

namespace sextant {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSameFaceRad = 1 * kDegree;
constexpr double kSamePoseRad = 5 * kDegree;
constexpr double kLevel = 0.001;  // of the radius: faces this much higher than the lowest are as low
constexpr double kSameLatitudeRad = 10 * kDegree;
constexpr double kRoundness = 0.03;  // of the radius: a hull this close to a surface of revolution is one
constexpr std::uint32_t kNoFace = ~std::uint32_t{0};

// A flat piece of the hull.
struct Face {
  std::vector<std::uint32_t> facets;
  Vector3d normal{0, 0, 1};
  double height = 0;                 // of the centre of mass above the face's plane
  double solid_angle = 0;            // seen from the centre of mass, steradian
  std::uint32_t rolls_to = kNoFace;  // the face that it tips onto; kNoFace: stable
};

double area_of(const ConvexHull& hull, const ConvexHull::Facet& f) {
  const Vector3d& a = hull.vertices[f.corners[0]];
  return 0.5 * (hull.vertices[f.corners[1]] - a).cross(hull.vertices[f.corners[2]] - a).norm();
}

// Van Oosterom and Strackee 1983, "The solid angle of a plane triangle".
double solid_angle_of(const ConvexHull& hull, const ConvexHull::Facet& f, const Vector3d& eye) {
  const Vector3d a = (hull.vertices[f.corners[0]] - eye).normalized();
  const Vector3d b = (hull.vertices[f.corners[1]] - eye).normalized();
  const Vector3d c = (hull.vertices[f.corners[2]] - eye).normalized();
  return std::abs(2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a)));
}

// Grows faces from the largest facets over neighbours that point almost the same way as the seed.
std::vector<Face> merge_into_faces(const ConvexHull& hull, std::vector<std::uint32_t>& face_of) {
  std::vector<double> area;
  for (const ConvexHull::Facet& f : hull.facets) area.push_back(area_of(hull, f));
  std::vector<std::uint32_t> seeds(hull.facets.size());
  std::iota(seeds.begin(), seeds.end(), 0U);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return area[a] > area[b]; });
  face_of.assign(hull.facets.size(), kNoFace);
  std::vector<Face> faces;
  for (const std::uint32_t seed : seeds) {
    if (face_of[seed] != kNoFace) continue;
    const auto index = static_cast<std::uint32_t>(faces.size());
    Face face;
    face.facets.push_back(seed);
    face_of[seed] = index;
    Vector3d normal = Vector3d::Zero();
    for (std::size_t i = 0; i < face.facets.size(); ++i) {
      const ConvexHull::Facet& facet = hull.facets[face.facets[i]];
      normal += area[face.facets[i]] * facet.normal;
      for (const std::uint32_t next : facet.across) {
        if (next == ConvexHull::kNoFacet || face_of[next] != kNoFace) continue;
        if (hull.facets[next].normal.dot(hull.facets[seed].normal) < std::cos(kSameFaceRad)) continue;
        face_of[next] = index;
        face.facets.push_back(next);
      }
    }
    face.normal = normal.norm() > 0 ? Vector3d(normal.normalized()) : hull.facets[seed].normal;
    faces.push_back(std::move(face));
  }
  return faces;
}

// Whether the centre of mass lies above the polygon (convex hull, Andrew's monotone chain) of the face's
// corners.
bool stands_on(const ConvexHull& hull, const Face& face, const Vector3d& mass) {
  const Vector3d x = face.normal.unitOrthogonal();
  const Vector3d y = face.normal.cross(x);
  std::vector<Eigen::Vector2d> points;
  for (const std::uint32_t f : face.facets) {
    for (const std::uint32_t v : hull.facets[f].corners) {
      const Vector3d p = hull.vertices[v] - mass;
      points.emplace_back(x.dot(p), y.dot(p));
    }
  }
  std::sort(points.begin(), points.end(), [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  const auto turn = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  };
  std::vector<Eigen::Vector2d> polygon;
  for (const bool upper : {false, true}) {
    const std::size_t base = polygon.size();
    for (const Eigen::Vector2d& p : points) {
      while (polygon.size() >= base + 2 && turn(polygon[polygon.size() - 2], polygon.back(), p) <= 0)
        polygon.pop_back();
      polygon.push_back(p);
    }
    polygon.pop_back();
    if (!upper) std::reverse(points.begin(), points.end());
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (turn(polygon[i], polygon[(i + 1) % polygon.size()], Eigen::Vector2d::Zero()) < 0) return false;
  }
  return true;
}

// The lower face across the border edge that is closest to the foot of the centre of mass: a body that
// cannot stand rolls downhill. kNoFace where no neighbour is lower (rounding, or a smooth bottom).
std::uint32_t tips_onto(const ConvexHull& hull, const std::vector<Face>& faces,
                        const std::vector<std::uint32_t>& face_of, std::uint32_t index,
                        const Vector3d& mass) {
  const Face& face = faces[index];
  if (stands_on(hull, face, mass)) return kNoFace;
  const auto flat = [&](const Vector3d& p) { return Vector3d(p - face.normal * face.normal.dot(p - mass)); };
  double closest = std::numeric_limits<double>::infinity();
  double most_beyond = 0;
  std::uint32_t next = kNoFace;
  for (const std::uint32_t f : face.facets) {
    const ConvexHull::Facet& facet = hull.facets[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t across = facet.across.at(k);
      if (across == ConvexHull::kNoFacet || faces[face_of[across]].height >= face.height) continue;
      const Vector3d a = flat(hull.vertices[facet.corners.at(k)]);
      const Vector3d b = flat(hull.vertices[facet.corners.at((k + 1) % 3)]);
      const Vector3d along = b - a;
      const double length = along.norm();
      if (!(length > 0)) continue;
      const double beyond = along.cross(face.normal).dot(mass - a) / length;  // > 0: outside of this edge
      const double t = std::clamp(along.dot(mass - a) / (length * length), 0.0, 1.0);
      const double distance = (a + t * along - mass).norm();
      // Two edges that meet in the closest corner: the one that the foot is more beyond of.
      if (distance < closest - 1e-12 || (distance < closest + 1e-12 && beyond > most_beyond)) {
        closest = distance;
        most_beyond = beyond;
        next = face_of[across];
      }
    }
  }
  return next;
}

// Hands poses that a slight knock would end (a facet of a scanned barrel) to the deeper pose beyond. This is
// the persistence of the minima of the centre's height over the graph of faces: passages between faces, by
// how high the centre must rise over the edge, join valleys; the shallower valley ends if its depth below
// the passage is less than `least_depth`. rest[i]: the pose where face i comes to rest.
void fill_shallow_valleys(const ConvexHull& hull, const std::vector<Face>& faces,
                          const std::vector<std::uint32_t>& face_of, const Vector3d& mass, double least_depth,
                          std::vector<std::uint32_t>& rest) {
  struct Passage {
    double height;
    std::uint32_t from, to;
  };
  std::vector<Passage> passages;
  for (std::uint32_t f = 0; f < hull.facets.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t across = hull.facets[f].across.at(k);
      if (across == ConvexHull::kNoFacet || across < f || face_of[across] == face_of[f]) continue;
      const Vector3d& a = hull.vertices[hull.facets[f].corners.at(k)];
      const Vector3d along = hull.vertices[hull.facets[f].corners.at((k + 1) % 3)] - a;
      const Face& here = faces[face_of[f]];
      const Face& there = faces[face_of[across]];
      // Where the centre is already beyond the edge, nothing has to rise.
      const bool downhill =
          along.cross(here.normal).dot(mass - a) > 0 || along.cross(there.normal).dot(mass - a) < 0;
      const double t = std::clamp(along.dot(mass - a) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
      const double height = downhill ? std::max(here.height, there.height) : (a + t * along - mass).norm();
      passages.push_back({height, face_of[f], face_of[across]});
    }
  }
  std::stable_sort(passages.begin(), passages.end(),
                   [](const Passage& a, const Passage& b) { return a.height < b.height; });
  std::vector<std::uint32_t> valley(rest);  // union-find forest over poses; the root is the deepest
  std::vector<std::uint32_t> deeper(faces.size(), kNoFace);  // where an ended pose's share goes
  const auto root = [&](std::uint32_t i) {
    while (valley[i] != i) i = valley[i] = valley[valley[i]];
    return i;
  };
  for (const Passage& passage : passages) {
    std::uint32_t low = root(passage.from);
    std::uint32_t high = root(passage.to);
    if (low == high) continue;
    if (std::tie(faces[high].height, high) < std::tie(faces[low].height, low)) std::swap(low, high);
    if (passage.height - faces[high].height < least_depth) deeper[high] = low;
    valley[high] = low;
  }
  for (std::uint32_t& r : rest) {
    while (deeper[r] != kNoFace) r = deeper[r];
  }
}

// An axis about which the hull is a surface of revolution, if any; `sphere`: it is one about every axis.
struct Revolution {
  bool any = false;
  bool sphere = false;
  Vector3d axis{0, 0, 1};
};

// How far the hull reaches from the point `from` in direction `d`.
class SupportDistance {
 public:
  SupportDistance(const ConvexHull& hull, const Vector3d& from) : hull_(hull), from_(from) {}
  double operator()(const Vector3d& d) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vector3d& p : hull_.vertices) most = std::max(most, d.dot(p - from_));
    return most;
  }

 private:
  const ConvexHull& hull_;
  const Vector3d& from_;
};

bool is_round_about(const SupportDistance& support, const Vector3d& axis, double tolerance) {
  // Two convex bodies are within a distance of each other exactly if their support functions are.
  const Vector3d x = axis.unitOrthogonal();
  const Vector3d y = axis.cross(x);
  constexpr int kLatitudes = 12;
  constexpr int kLongitudes = 60;
  for (int i = 1; i < kLatitudes; ++i) {
    const double latitude = std::numbers::pi * i / kLatitudes;
    double lo = std::numeric_limits<double>::infinity();
    double hi = -lo;
    for (int k = 0; k < kLongitudes; ++k) {
      const double longitude = 2 * std::numbers::pi * k / kLongitudes;
      const double reach = support(std::cos(latitude) * axis +
                                   std::sin(latitude) * (std::cos(longitude) * x + std::sin(longitude) * y));
      lo = std::min(lo, reach);
      hi = std::max(hi, reach);
      if (hi - lo > tolerance) return false;
    }
  }
  return true;
}

// Candidates are the principal axes of the hull's surface and the normals of its largest faces (a can as
// high as it is wide has no principal axes).
Revolution revolution_of(const ConvexHull& hull, const std::vector<Face>& faces) {
  Vector3d centre = Vector3d::Zero();
  double area = 0;
  for (const ConvexHull::Facet& f : hull.facets) {
    const double a = area_of(hull, f);
    centre +=
        a * (hull.vertices[f.corners[0]] + hull.vertices[f.corners[1]] + hull.vertices[f.corners[2]]) / 3;
    area += a;
  }
  centre /= area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double radius = 0;
  for (const ConvexHull::Facet& f : hull.facets) {
    // Exact second moment of a triangle: its edges' middles with equal weights.
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d p =
          0.5 * (hull.vertices[f.corners.at(k)] + hull.vertices[f.corners.at((k + 1) % 3)]) - centre;
      spread += area_of(hull, f) / 3 * p * p.transpose();
    }
  }
  for (const Vector3d& p : hull.vertices) radius = std::max(radius, (p - centre).norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(spread);
  const SupportDistance support(hull, centre);
  std::vector<Vector3d> candidates;
  for (int k = 0; k < 3; ++k) candidates.push_back(principal.eigenvectors().col(k));
  constexpr std::size_t kLargestFaces = 4;  // faces come from seeds in order of size
  for (std::size_t i = 0; i < std::min(kLargestFaces, faces.size()); ++i)
    candidates.push_back(faces[i].normal);
  Revolution result;
  for (const Vector3d& axis : candidates) {
    if (!is_round_about(support, axis, kRoundness * radius)) continue;
    if (result.any && std::abs(axis.dot(result.axis)) < 0.9) result.sphere = true;
    if (!result.any) result = {true, false, axis};
  }
  return result;
}

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

bool same_pose(const Vector3d& a, const Vector3d& b, const Revolution& revolution) {
  if (angle_between(a, b) < kSamePoseRad || revolution.sphere) return true;
  return revolution.any &&
         std::abs(angle_between(a, revolution.axis) - angle_between(b, revolution.axis)) < kSameLatitudeRad;
}

// Order of poses: likelier first; then by which way of the mesh is up, coarsely first so that rounding
// does not decide.
bool comes_before(const Vector3d& up_a, double probability_a, const Vector3d& up_b, double probability_b) {
  constexpr double kGrain = 1e5;
  const auto grains = [](double value) { return std::llround(value * kGrain); };
  if (grains(probability_a) != grains(probability_b)) return probability_a > probability_b;
  for (const int axis : {2, 1, 0}) {
    if (grains(up_a[axis]) != grains(up_b[axis])) return up_a[axis] > up_b[axis];
  }
  return probability_a > probability_b;
}

}  // namespace

Eigen::Matrix3d rotation_that_raises(const Vector3d& up) {
  const Vector3d z = up.normalized();
  if (z.z() < -1 + 1e-12) return Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).toRotationMatrix();
  return Eigen::Quaterniond::FromTwoVectors(z, Vector3d::UnitZ()).toRotationMatrix();
}

Vector3d up_in_mesh(const RestingPose& pose) { return pose.object_from_mesh.row(2); }

std::vector<RestingPose> resting_poses(const ConvexHull& hull, const Vector3d& centre_of_mass,
                                       double rattle) {
  std::vector<std::uint32_t> face_of;
  std::vector<Face> faces = merge_into_faces(hull, face_of);
  for (Face& face : faces) {
    face.height = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t f : face.facets) {
      face.solid_angle += solid_angle_of(hull, hull.facets[f], centre_of_mass);
      for (const std::uint32_t v : hull.facets[f].corners) {
        face.height = std::max(face.height, face.normal.dot(hull.vertices[v] - centre_of_mass));
      }
    }
  }
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    faces[i].rolls_to = tips_onto(hull, faces, face_of, i, centre_of_mass);
  }

  // From the lowest face up: each unstable one rests where the lower one rests that it tips onto.
  std::vector<std::uint32_t> uphill(faces.size());
  std::iota(uphill.begin(), uphill.end(), 0U);
  std::stable_sort(uphill.begin(), uphill.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return faces[a].height < faces[b].height; });
  std::vector<std::uint32_t> rest(faces.size());
  for (const std::uint32_t i : uphill) rest[i] = faces[i].rolls_to == kNoFace ? i : rest[faces[i].rolls_to];
  double radius = 0;
  for (const Vector3d& p : hull.vertices) radius = std::max(radius, (p - centre_of_mass).norm());
  fill_shallow_valleys(hull, faces, face_of, centre_of_mass, rattle * radius, rest);
  double total = 0;
  std::vector<double> share(faces.size(), 0.0);
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    share[rest[i]] += faces[i].solid_angle;
    total += faces[i].solid_angle;
  }

  // A barrel rests on any of many faces: the one that stands for them is the likeliest of the lowest ones.
  struct Candidate {
    Vector3d up;
    double probability;
  };
  const double level = kLevel * radius;
  std::vector<std::uint32_t> shown(rest);
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const std::uint32_t lowest = rest[i];
    if (faces[i].rolls_to != kNoFace || faces[i].height > faces[lowest].height + level) continue;
    const Face& best = faces[shown[lowest]];
    if (comes_before(-faces[i].normal, faces[i].solid_angle / total, -best.normal,
                     best.solid_angle / total)) {
      shown[lowest] = i;
    }
  }
  std::vector<Candidate> stable;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    if (rest[i] == i) stable.push_back({-faces[shown[i]].normal, share[i] / total});
  }
  const auto before = [](const Candidate& a, const Candidate& b) {
    return comes_before(a.up, a.probability, b.up, b.probability);
  };
  std::sort(stable.begin(), stable.end(), before);
  const Revolution revolution = revolution_of(hull, faces);
  std::vector<Candidate> merged;
  for (const Candidate& one : stable) {
    const auto same = std::find_if(merged.begin(), merged.end(), [&](const Candidate& other) {
      return same_pose(one.up, other.up, revolution);
    });
    if (same != merged.end()) {
      same->probability += one.probability;
    } else {
      merged.push_back(one);
    }
  }
  std::sort(merged.begin(), merged.end(), before);

  std::vector<RestingPose> poses;
  const SupportDistance support(hull, centre_of_mass);
  for (const Candidate& pose : merged) {
    poses.push_back({rotation_that_raises(pose.up), pose.probability, support(pose.up) + support(-pose.up)});
  }
  return poses;
}

std::string describe_resting_poses(const std::vector<RestingPose>& poses) {
  std::string text;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector3d up = up_in_mesh(poses[i]);
    int axis = 0;
    std::string direction;
    if (up.cwiseAbs().maxCoeff(&axis) > std::cos(0.5 * kDegree)) {
      direction = fmt::format("{}{}", up[axis] > 0 ? '+' : '-', "xyz"[axis]);
    } else {
      direction = fmt::format("({:.2f}, {:.2f}, {:.2f})", up[0], up[1], up[2]);
    }
    text += fmt::format("{}: {:.1f} %, {:.3f} m high, mesh {} up\n", i, 100 * poses[i].probability,
                        poses[i].height_m, direction);
  }
  return text;
}

}  // namespace sextant
