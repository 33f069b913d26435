// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/refiner.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "runtime/refine/contour_edges.h"
#include "runtime/refine/depth_outline.h"
#include "runtime/refine/depth_raster.h"
#include "runtime/refine/depth_term.h"
#include "runtime/refine/edge_term.h"
#include "runtime/refine/local_table.h"
#include "runtime/refine/picture_comparison.h"
#include "runtime/refine/sensor_noise.h"

namespace sextant {
namespace {

/// One round: how far off an observation may be and still count.
struct Gates {
  double depth_m;
  double edge_px;     ///< at f = 525; 0: edges are not looked at
  double outline_px;  ///< the same for the outline in the depth image
};
// Depth first: it leads to the right place from farther away, while the nearest edge may be a wrong one.
constexpr std::array<Gates, 6> kDepthFirst{
    {{0.035, 0, 22}, {0.022, 7, 16}, {0.016, 6, 12}, {0.012, 5, 8}, {0.010, 4, 6}, {0.010, 3, 5}}};
// Edges first, for objects whose depth is missing or says little.
constexpr std::array<Gates, 5> kTogether{
    {{0.035, 6, 12}, {0.022, 6, 10}, {0.014, 5, 8}, {0.010, 4, 6}, {0.010, 3, 5}}};
constexpr Gates kLast{0.010, 3, 5};
// An optimum that explains this much of depth and edges needs no second attempt.
constexpr double kGoodAgreement = 1.0;

// The lattice pose as a weak prior: it holds what nothing else observes.
constexpr double kPriorShiftM = 0.015;
constexpr double kPriorTurnRad = 0.12;
constexpr double kEdgeSpacingPx = 3;  // at f = 525
constexpr double kHalfTurnVariance = std::numbers::pi * std::numbers::pi / 3;

Eigen::Matrix3d turned(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
}

/// How much of what could be seen the pose explains: 0..2.
double agreement(const Refinement& q) {
  const double seen = 1 - q.missing_share - q.occluded_share;
  const double depth = seen > 0.05 ? (q.depth_inlier_share - q.off_surface_share) / seen : 0;
  // What stands in front is no misfit, but a pose that hides the object behind things is not better for it.
  return depth * (1 - 0.5 * q.occluded_share) + q.edge_inlier_share;
}

void add_table_term(const LocalTable& table, double centre_height_m, const RigidTransform& pose,
                    NormalEquations& normal) {
  const Eigen::Vector3d up = table.table.up_in_camera;
  const double height = up.dot(pose.translation()) + table.table.camera_height_m;
  normal.add<3>({up.x(), up.y(), up.z()}, centre_height_m - height,
                1 / (table.height_sigma_m * table.height_sigma_m));
  // The turn w moves the object's vertical a to a + w x a; it should be `up`.
  const Eigen::Vector3d vertical = pose.linear().col(2);
  const Eigen::Vector3d side = up.unitOrthogonal();
  const Eigen::Vector3d ahead = up.cross(side);
  for (const Eigen::Vector3d& across : {side, ahead}) {
    const Eigen::Vector3d turn = vertical.cross(across);
    normal.add<6>({0, 0, 0, turn.x(), turn.y(), turn.z()}, across.dot(up - vertical),
                  1 / (table.tilt_sigma_rad * table.tilt_sigma_rad));
  }
}

/// The pose and what the pixels share, while they are being improved.
struct Estimate {
  RigidTransform pose = RigidTransform::Identity();
  Shared shared = Shared::Zero();
};

/// Priors of what is shared, and of the pose around the lattice pose.
void add_priors(const Estimate& now, const RigidTransform& lattice, NormalEquations& normal) {
  const Eigen::Vector3d shift = lattice.translation() - now.pose.translation();
  const Eigen::AngleAxisd back(Eigen::Matrix3d(lattice.linear() * now.pose.linear().transpose()));
  const double z = now.pose.translation().norm();
  const double slope = DepthNoise::warp_slope_m(z);
  State sigma;
  sigma << Eigen::Vector3d::Constant(kPriorShiftM), Eigen::Vector3d::Constant(kPriorTurnRad),
      DepthNoise::warp_m(z), slope, slope, DepthNoise::kShiftTangent, DepthNoise::kShiftTangent;
  State residual;
  residual << shift, back.angle() * back.axis(), -now.shared;
  const State information = sigma.array().square().inverse();
  normal.a.diagonal() += information;
  normal.b += information.cwiseProduct(residual);
}

/// Takes the spin about a rotational symmetry's axis out of the problem.
void hold_spin(const Eigen::Vector3d& axis, NormalEquations& normal) {
  State spin = State::Zero();
  spin.segment<3>(3) = axis;
  const Information keep = Information::Identity() - spin * spin.transpose();
  const Information full = keep * normal.full() * keep;
  normal.a = full + spin * spin.transpose() / kHalfTurnVariance;
  normal.b -= spin * spin.dot(normal.b);
}

}  // namespace

struct Refiner::Impl {
  const ObjectModel& model;
  ContourEdges contours;
  DepthRaster raster;
  DepthRaster other_raster;  ///< of the pose that one is compared with
  std::vector<EdgeSample> samples;

  explicit Impl(const ObjectModel& m) : model(m), contours(m) {}

  /// What one frame and one lattice pose ask for.
  struct Task {
    const RefineFrame& input;
    const RigidTransform& lattice;
    std::optional<LocalTable> table;
  };

  NormalEquations linearised(const Task& task, const Estimate& now, const Gates& gates, Refinement* quality) {
    const SearchFrame& frame = task.input.frame;
    raster.draw(model.mesh, now.pose, frame.camera);
    NormalEquations normal;
    add_depth_term(frame, raster, contours.face_normals(), now.pose, now.shared, gates.depth_m, normal,
                   quality);
    contours.sample(now.pose, frame.camera, raster, kEdgeSpacingPx * edge_scale(frame.camera), samples);
    add_depth_outline_term(frame, raster, samples, now.pose, now.shared, gates.outline_px, normal);
    if (gates.edge_px > 0) {
      add_edge_term(frame, task.input.edges, samples, now.pose, gates.edge_px, normal, quality);
    }
    if (task.table) add_table_term(*task.table, model.centre_height_m, now.pose, normal);
    add_priors(now, task.lattice, normal);
    if (model.symmetry_deg == 0) hold_spin(now.pose.linear().col(2), normal);
    return normal;
  }

  /// Gauss-Newton over the rounds.
  Estimate improved(const Task& task, std::span<const Gates> rounds) {
    Estimate now{task.lattice, Shared::Zero()};
    for (const Gates& gates : rounds) {
      const NormalEquations normal = linearised(task, now, gates, nullptr);
      const State step = normal.full().ldlt().solve(normal.b);
      if (!step.allFinite()) break;
      now.pose.translation() += step.head<3>();
      now.pose.linear() =
          Eigen::Quaterniond(turned(step.segment<3>(3)) * now.pose.linear()).normalized().toRotationMatrix();
      now.shared += step.tail<kSharedUnknowns>();
    }
    return now;
  }

  /// Quality and covariance at an estimate.
  RefinedPose judged(const Task& task, const Estimate& at) {
    RefinedPose result;
    result.camera_from_object = at.pose;
    const NormalEquations normal = linearised(task, at, kLast, &result.quality);
    const Information inverse = normal.full().ldlt().solve(Information::Identity());
    const Eigen::Matrix<double, 6, 6> pose = inverse.topLeftCorner<6, 6>();
    result.covariance = 0.5 * (pose + pose.transpose());
    Refinement& q = result.quality;
    q.shift_m = (at.pose.translation() - task.lattice.translation()).norm();
    q.turn_rad = rotation_angle_between(at.pose, task.lattice);
    q.left_neighbourhood = !(q.shift_m <= kMaxShiftM) || !(q.turn_rad <= kMaxTurnRad);
    q.refined = true;
    return result;
  }

  RefinedPose refine(const RefineFrame& input, const RigidTransform& lattice) {
    if (model.mesh.triangles.empty()) {
      RefinedPose same;
      same.camera_from_object = lattice;
      return same;
    }
    Task task{input, lattice, std::nullopt};
    raster.draw(model.mesh, lattice, input.frame.camera);
    if (input.table) {
      task.table = local_table(input.frame, *input.table, input.tolerance, raster, lattice.translation());
    }
    RefinedPose best = judged(task, improved(task, kDepthFirst));
    if (best.quality.left_neighbourhood || agreement(best.quality) < kGoodAgreement) {
      RefinedPose other = judged(task, improved(task, kTogether));
      const bool better = agreement(other.quality) > agreement(best.quality);
      if (!other.quality.left_neighbourhood && (best.quality.left_neighbourhood || better)) best = other;
    }
    if (!best.quality.left_neighbourhood) return best;
    // Outside of what the certificate speaks of: the lattice pose stays, and the answer says so.
    RefinedPose kept = judged(task, {lattice, Shared::Zero()});
    kept.quality.refined = false;
    kept.quality.left_neighbourhood = true;
    kept.quality.shift_m = best.quality.shift_m;
    kept.quality.turn_rad = best.quality.turn_rad;
    // Nothing was found around it: as uncertain as any lattice pose.
    kept.covariance.diagonal().head<3>().array() += kPriorShiftM * kPriorShiftM;
    kept.covariance.diagonal().tail<3>().array() += kPriorTurnRad * kPriorTurnRad;
    return kept;
  }
};

Refiner::Refiner(const ObjectModel& model) : impl_(std::make_unique<Impl>(model)) {}
Refiner::~Refiner() = default;
Refiner::Refiner(Refiner&&) noexcept = default;

RefinedPose Refiner::refine(const RefineFrame& input, const RigidTransform& camera_from_object) {
  return impl_->refine(input, camera_from_object);
}

double Refiner::compare(const RefineFrame& input, const RigidTransform& first, const RigidTransform& second) {
  const PinholeCamera& camera = input.frame.camera;
  impl_->raster.draw(impl_->model.mesh, first, camera);
  impl_->other_raster.draw(impl_->model.mesh, second, camera);
  return explained_better(input.frame, input.table, impl_->raster, impl_->other_raster);
}

Eigen::Matrix<double, 6, 6> moved_covariance(const Eigen::Matrix<double, 6, 6>& covariance,
                                             const Eigen::Vector3d& offset) {
  Eigen::Matrix<double, 6, 6> move = Eigen::Matrix<double, 6, 6>::Identity();
  // d(position) = w x offset = -[offset]x w
  move.topRightCorner<3, 3>() << 0, offset.z(), -offset.y(), -offset.z(), 0, offset.x(), offset.y(),
      -offset.x(), 0;
  return move * covariance * move.transpose();
}

Eigen::Matrix<double, 6, 6> with_model_error(const Eigen::Matrix<double, 6, 6>& covariance) {
  constexpr double kShiftM = 0.0015;
  constexpr double kTurnRad = 0.017;  // 1 deg
  Eigen::Matrix<double, 6, 6> out = covariance;
  out.diagonal().head<3>().array() += kShiftM * kShiftM;
  out.diagonal().tail<3>().array() += kTurnRad * kTurnRad;
  return out;
}

}  // namespace sextant
