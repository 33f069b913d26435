// SPDX-License-Identifier: Apache-2.0
// What the refinement gains: errors of given poses before and after it against the ground truth of a data
// set, the consistency of its covariance (NEES: squared error in units of the covariance, about 6 on average
// where it is honest, 5 for a round object), and its time. The poses are those of a results file (sextant
// detect
// --no-refine --csv), or the truth, moved at random (--perturb).
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <numbers>

#include "hal/playback/bop_dataset.h"
#include "offline/dataset/bop_results.h"
#include "offline/synthesize/random.h"
#include "runtime/base/error.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/model/model_file.h"
#include "runtime/refine/refiner.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Options {
  std::vector<std::filesystem::path> models;
  std::filesystem::path dataset, csv;
  int perturb = 0;
  double perturb_mm = 8, perturb_deg = 4;
  double angle_tolerance_deg = 6;
  bool verbose = false, geometric = false;
  bool no_table = false;
};

/// What is left of a pose's error when symmetries are forgiven.
struct Error {
  double shift_m = 0, turn_rad = 0, tilt_rad = 0;
  Eigen::Matrix<double, 6, 1> vector;  ///< true minus estimated, as the covariance means it
  bool within(double m, double degrees) const { return shift_m <= m && turn_rad <= degrees * kDegree; }
};

/// Processor time of this thread: what a busy machine does besides does not count.
double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

Eigen::Vector3d log_rotation(const Eigen::Matrix3d& r) {
  const Eigen::AngleAxisd a(r);
  return a.angle() * a.axis();
}

Error error_of(const RigidTransform& estimate, const RigidTransform& truth, int symmetry_deg) {
  Error e;
  e.shift_m = (truth.translation() - estimate.translation()).norm();
  e.tilt_rad = std::acos(std::clamp(truth.linear().col(2).dot(estimate.linear().col(2)), -1.0, 1.0));
  Eigen::Vector3d turn = Eigen::Vector3d::Constant(10);
  const int steps = symmetry_deg == 0 ? 3600 : 360 / symmetry_deg;
  for (int k = 0; k < steps; ++k) {
    const Eigen::AngleAxisd spin(2 * std::numbers::pi * k / steps, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d w = log_rotation(truth.linear() * spin * estimate.linear().transpose());
    if (w.norm() < turn.norm()) turn = w;
  }
  e.turn_rad = turn.norm();
  e.vector << truth.translation() - estimate.translation(), turn;
  return e;
}

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

struct Tally {
  std::vector<double> shift, turn, tilt;
  int n = 0, right = 0, fine = 0;
  void add(const Error& e) {
    ++n;
    shift.push_back(1e3 * e.shift_m);
    turn.push_back(e.turn_rad / kDegree);
    tilt.push_back(e.tilt_rad / kDegree);
    right += e.within(0.01, 15) ? 1 : 0;
    fine += e.within(0.005, 5) ? 1 : 0;
  }
  void print(const std::string& name) const {
    fmt::print(
        "{:<22} {:4} poses  position {:5.2f} mm  turn {:5.2f} deg  tilt {:5.2f} deg  1 cm/15 deg {:5.1f} %  "
        "5 mm/5 deg {:5.1f} %\n",
        name, n, median(shift), median(turn), median(tilt), 100.0 * right / std::max(1, n),
        100.0 * fine / std::max(1, n));
  }
};

struct ModelTally {
  Tally before, after;
  std::vector<double> nees, published_nees, seconds;
  int left = 0;
};

/// Starting poses of one object in one image: object frame, and the truth each belongs to.
std::vector<std::pair<RigidTransform, RigidTransform>> starts(const Options& o, const ObjectModel& model,
                                                              const BopImage& image,
                                                              const std::vector<BopResult>& rows,
                                                              Random& random) {
  std::vector<std::pair<RigidTransform, RigidTransform>> out;
  const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
  std::vector<RigidTransform> truths;
  for (const BopGt& gt : image.ground_truth) {
    if (gt.object_id != model.object_id) continue;
    if (gt.visible_fraction.value_or(1) < 0.3) continue;
    const RigidTransform truth = gt.camera_from_mesh * mesh_from_object;
    if (image.table && truth.linear().col(2).dot(image.table->up_in_camera) < 0.93) continue;
    truths.push_back(truth);
  }
  for (const RigidTransform& truth : truths) {
    for (int k = 0; k < o.perturb; ++k) {
      Eigen::Vector3d shift;
      Eigen::Vector3d turn;
      for (int i = 0; i < 3; ++i) {
        shift[i] = o.perturb_mm * 1e-3 * random.normal();
        turn[i] = o.perturb_deg * kDegree * random.normal();
      }
      RigidTransform start = truth;
      start.translation() += shift;
      start.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * truth.linear();
      out.emplace_back(start, truth);
    }
  }
  for (const BopResult& row : rows) {
    if (row.scene_id != image.scene_id || row.image_id != image.image_id ||
        row.object_id != model.object_id || truths.empty()) {
      continue;
    }
    const RigidTransform start = row.camera_from_mesh * mesh_from_object;
    const auto nearest = std::min_element(truths.begin(), truths.end(), [&](const auto& a, const auto& b) {
      return (a.translation() - start.translation()).norm() < (b.translation() - start.translation()).norm();
    });
    out.emplace_back(start, *nearest);
  }
  return out;
}

void print_pose(const BopImage& image, const ObjectModel& model, const Error& before, const Error& after,
                double nees, const RefinedPose& refined) {
  const Refinement& q = refined.quality;
  fmt::print(
      "{:6} {:4} {:<12} {:5.1f} mm {:5.1f} deg {:4.1f} -> {:5.1f} mm {:5.1f} deg {:4.1f}  nees {:7.1f}  "
      "depth in {:.2f} off "
      "{:.2f} occ {:.2f} missing {:.2f} rms {:.1f} mm  edges {:.2f} outline {:.2f} {:.2f} px of {}{}  xyz "
      "{:.1f} {:.1f} "
      "{:.1f}\n",
      image.scene_id, image.image_id, model.name, 1e3 * before.shift_m, before.turn_rad / kDegree,
      before.tilt_rad / kDegree, 1e3 * after.shift_m, after.turn_rad / kDegree, after.tilt_rad / kDegree,
      nees, q.depth_inlier_share, q.off_surface_share, q.occluded_share, q.missing_share, 1e3 * q.depth_rms_m,
      q.edge_inlier_share, q.outline_inlier_share, q.edge_rms_px, q.edge_samples,
      q.left_neighbourhood ? "  LEFT" : "", 1e3 * after.vector[0], 1e3 * after.vector[1],
      1e3 * after.vector[2]);
}

int run(const Options& o) {
  std::vector<ObjectModel> models;
  for (const auto& file : o.models) models.push_back(read_model(file));
  std::vector<Refiner> refiners;
  for (const ObjectModel& model : models) refiners.emplace_back(model);
  std::vector<BopResult> rows;
  if (!o.csv.empty()) rows = read_bop_results(o.csv);
  const BopDataset set = open_bop_dataset(o.dataset, "test");
  std::vector<ModelTally> tallies(models.size());
  Random random(7);
  for (const BopImage& image : set.images) {
    const SearchFrame frame = rectified(load_frame(image));
    const cv::Mat edges = edges_by_direction(frame.colour);
    TableTolerance tolerance;
    tolerance.angle_rad = o.angle_tolerance_deg * kDegree;
    const RefineFrame seen{frame, edges, o.no_table ? std::nullopt : image.table, tolerance};
    for (std::size_t m = 0; m < models.size(); ++m) {
      const int symmetry = o.geometric ? models[m].geometric_symmetry_deg : models[m].symmetry_deg;
      for (const auto& [start, truth] : starts(o, models[m], image, rows, random)) {
        const double begin = cpu_ms();
        const RefinedPose refined = refiners[m].refine(seen, start);
        const double took = cpu_ms() - begin;
        const Error before = error_of(start, truth, symmetry);
        const Error after = error_of(refined.camera_from_object, truth, symmetry);
        const double nees = after.vector.dot(refined.covariance.inverse() * after.vector);
        tallies[m].before.add(before);
        tallies[m].after.add(after);
        tallies[m].seconds.push_back(took);
        const double published =
            after.vector.dot(with_model_error(refined.covariance).inverse() * after.vector);
        if (after.within(0.03, 15)) {
          tallies[m].nees.push_back(nees);
          tallies[m].published_nees.push_back(published);
        }
        tallies[m].left += refined.quality.left_neighbourhood ? 1 : 0;
        if (o.verbose) print_pose(image, models[m], before, after, nees, refined);
      }
    }
  }
  for (std::size_t m = 0; m < models.size(); ++m) {
    const ModelTally& t = tallies[m];
    t.before.print(models[m].name + " before");
    t.after.print(models[m].name + " after");
    double mean = 0;
    for (const double n : t.nees) mean += n / static_cast<double>(t.nees.size());
    fmt::print(
        "{:<22} NEES mean {:.1f} median {:.1f}, as published {:.1f} of {}; left the neighbourhood {}; {:.2f} "
        "ms (median), {} "
        "triangles, {} marks\n",
        "", mean, median(t.nees), median(t.published_nees), t.nees.size(), t.left, median(t.seconds),
        models[m].mesh.triangles.size(), models[m].marks.size());
  }
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  sextant::Options o;
  CLI::App app("errors of poses before and after refinement");
  app.add_option("models", o.models)->required();
  app.add_option("--dataset", o.dataset)->required();
  app.add_option("--csv", o.csv, "poses to refine (BOP results)");
  app.add_option("--perturb", o.perturb, "true poses moved at random, so many each");
  app.add_option("--perturb-mm", o.perturb_mm, "standard deviation per axis");
  app.add_option("--perturb-deg", o.perturb_deg, "standard deviation per axis");
  app.add_option("--angle-tolerance-deg", o.angle_tolerance_deg);
  app.add_flag("--no-table", o.no_table, "without the contact with the table");
  app.add_flag("--geometric", o.geometric, "forgive what only the print tells");
  app.add_flag("--verbose", o.verbose);
  CLI11_PARSE(app, argc, argv);
  try {
    return sextant::run(o);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 3;
  }
}
