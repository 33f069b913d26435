// SPDX-License-Identifier: Apache-2.0
// Is the truth the best pose of the score? For every image of data sets with ground truth the highest scores
// are sought by hill climbing from dense starts (all over the image, and around the truth at every turntable
// angle), which takes a tenth of a second where a proof takes longer, and knows nothing of bounds. Switches
// turn parts of the score off one by one. The tables in docs/SCORING.md come from here.
//
//   sextant-scoring-bench -d SET[,SET...] [-o ID] [-n IMAGES] [--gain G] [--blur PX] [--fixed-edges]
//                         [--cut SHARE] MODEL[@switch,switch...]...
// Switches: thesis, outside-unknown, no-table, no-rim, no-weight, no-statistics, visual=S, depth=S, table=S,
// occluder=S.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <set>
#include <sstream>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/model/model_file.h"
#include "runtime/search/constraint.h"
#include "runtime/search/evaluate.h"

namespace sextant {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLowest = -std::numeric_limits<double>::infinity();
constexpr int kStartStepPx = 10;
constexpr std::size_t kClimbs = 25;

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> out;
  std::stringstream stream(text);
  for (std::string item; std::getline(stream, item, at);) out.push_back(item);
  return out;
}

/// A model under switches.
struct Candidate {
  std::string name;
  ObjectModel model;
  std::vector<ScoredBin> bins;

  explicit Candidate(const std::string& text) : name(text) {
    const auto at = text.find('@');
    model = read_model(text.substr(0, at));
    ScoringOptions options;
    for (const std::string& item :
         at == std::string::npos ? std::vector<std::string>{} : split(text.substr(at + 1), ',')) {
      turn(item, options);
    }
    bins = score_bins(model, options);
  }

  void turn(const std::string& item, ScoringOptions& options) {
    const auto equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const double value = equals == std::string::npos ? 0 : std::stod(item.substr(equals + 1));
    const auto drop = [&](DepthRole role) {
      for (ViewpointBin& bin : model.bins)
        std::erase_if(bin.depth, [&](const DepthPart& p) { return p.role == role; });
    };
    const auto change = [&](const auto& edit) {
      for (ViewpointBin& bin : model.bins) {
        for (VisualPart& p : bin.visual) edit(p.seen);
        for (DepthPart& p : bin.depth) edit(p.seen);
      }
    };
    if (key == "thesis") {
      options.scoring = Scoring::kThesis;
    } else if (key == "outside-unknown") {
      options.outside_is_unknown = true;
    } else if (key == "visual") {
      options.visual_scale = value;
    } else if (key == "depth") {
      options.depth_scale = value;
    } else if (key == "table") {
      options.table_scale = value;
    } else if (key == "occluder") {
      options.occluder_share = value;
    } else if (key == "no-table") {
      drop(DepthRole::kTable);
    } else if (key == "no-rim") {
      drop(DepthRole::kRim);
    } else if (key == "no-weight") {
      change([](PartStatistics& s) { s.weight = 1; });
    } else if (key == "no-statistics") {
      change([](PartStatistics& s) { s = {0, 0.75F, 0.15F, s.weight}; });
    } else {
      throw UsageError("there is no switch " + item);
    }
  }

  /// Bin of the pose (its rz brought into the symmetry's range), or -1.
  int place(LatticePose& p) const {
    const int turn = model.symmetry_deg / kLatticeDegrees;
    p.at[kRz] = static_cast<std::int16_t>(turn == 0 ? 0 : ((p.at[kRz] % turn) + turn) % turn);
    for (std::size_t i = 0; i < bins.size(); ++i) {
      const RotationBox& box = bins[i].box;
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a)
        inside = inside && p.at[kRx + a] >= first_angle(box.lo_deg[a]) &&
                 p.at[kRx + a] <= last_angle(box.hi_deg[a]);
      if (inside) return p.bin = static_cast<int>(i);
    }
    return p.bin = -1;
  }
};

struct Hit {
  LatticePose pose;
  double score = kLowest;
};

/// One image for one candidate.
class Landscape {
 public:
  Landscape(const Candidate& candidate, const FrameTables& tables, const Constraint& constraint)
      : candidate_(candidate), tables_(tables), constraint_(constraint) {}

  Hit score(LatticePose p) const {
    if (p.at[kX] < 0 || p.at[kY] < 0 || p.at[kX] >= tables_.width() || p.at[kY] >= tables_.height())
      return {};
    if (candidate_.place(p) < 0 || !constraint_.contains(p)) return {};
    return {p, evaluate(candidate_.bins[static_cast<std::size_t>(p.bin)], tables_, p)};
  }

  Hit climb(const LatticePose& from) const {
    Hit best = score(from);
    if (best.score == kLowest) return best;
    std::mt19937 random(7);
    for (const int step : {4, 2, 1, 4, 2, 1}) {
      for (int round = 0; round < 40; ++round) {
        Hit next = best;
        const auto attempt = [&](const LatticePose& p) {
          const Hit hit = score(p);
          if (hit.score > next.score) next = hit;
        };
        for (std::size_t d = 0; d < kDimensions; ++d) {
          for (const int sign : {-step, step}) {
            LatticePose p = best.pose;
            p.at[d] = static_cast<std::int16_t>(p.at[d] + sign);
            attempt(p);
          }
        }
        for (int k = 0; k < 12; ++k) {  // several coordinates at once: ridges are oblique
          LatticePose p = best.pose;
          for (auto& c : p.at) {
            c = static_cast<std::int16_t>(
                c + static_cast<int>(random() % static_cast<unsigned>(2 * step + 1)) - step);
          }
          attempt(p);
        }
        if (!(next.score > best.score)) break;
        best = next;
      }
    }
    return best;
  }

  /// The best of a grid over the image, upright on the table.
  std::vector<Hit> starts(const PinholeCamera& camera, const TableGeometry& table) const {
    std::vector<Hit> hits;
    const int turn = candidate_.model.symmetry_deg;
    for (int y = kStartStepPx / 2; y < camera.height; y += kStartStepPx) {
      for (int x = kStartStepPx / 2; x < camera.width; x += kStartStepPx) {
        const UprightPose up = upright_pose_at(camera, table.up_in_camera, x, y);
        if (up.sine_of_elevation <= 0) continue;
        const double z = (table.camera_height_m - candidate_.model.centre_height_m) / up.sine_of_elevation;
        if (z > 3) continue;
        Hit best;
        for (int rz = turn == 0 ? 0 : 5; rz < std::max(turn, 1); rz += 10) {
          const Hit hit = score(
              lattice_pose({static_cast<double>(x), static_cast<double>(y), z, up.rx, up.ry, rz * kDegree}));
          if (hit.score > best.score) best = hit;
        }
        if (best.score > kLowest) hits.push_back(best);
      }
    }
    std::stable_sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.score > b.score; });
    if (hits.size() > kClimbs) hits.resize(kClimbs);
    return hits;
  }

  static LatticePose lattice_pose(const Pose6& p) {
    const auto whole = [](double v) { return static_cast<std::int16_t>(std::lround(v)); };
    return {0,
            {whole(p.x), whole(p.y), whole(p.z / kLatticeDistance), whole(p.rx / kLatticeAngle),
             whole(p.ry / kLatticeAngle), whole(p.rz / kLatticeAngle)}};
  }

 private:
  const Candidate& candidate_;
  const FrameTables& tables_;
  const Constraint& constraint_;
};

struct Error {
  double mm = 1e9;
  double deg = 1e9;
  bool right() const { return mm < 10 && deg < 15; }
};

Error error_of(const RigidTransform& found, const RigidTransform& truth, int symmetry_deg) {
  const Eigen::Matrix3d r = truth.linear().transpose() * found.linear();
  Error e{1e3 * (found.translation() - truth.translation()).norm(), 1e9};
  if (symmetry_deg == 0) {
    e.deg = std::acos(std::clamp(r(2, 2), -1.0, 1.0)) / kDegree;
    return e;
  }
  for (int turn = 0; turn < 360; turn += symmetry_deg) {
    const Eigen::AngleAxisd by(turn * kDegree, Eigen::Vector3d::UnitZ());
    e.deg = std::min(
        e.deg, std::acos(std::clamp(((r * by.toRotationMatrix()).trace() - 1) / 2, -1.0, 1.0)) / kDegree);
  }
  return e;
}

double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

/// What came out for one candidate over all images.
struct Summary {
  int images = 0, right = 0;
  double margin = 0;  ///< of the best right pose over the best wrong one, in shares of the evidence
  std::vector<double> mm, deg, share_with, share_without;

  void print(const std::string& name) const {
    double above = 0;
    for (const double p : share_with) {
      for (const double n : share_without) above += p > n ? 1 : 0;
    }
    const double pairs = static_cast<double>(share_with.size() * share_without.size());
    fmt::print("{}: {}/{} right, median {:.1f} mm {:.1f} deg, margin {:+.3f}, evidence {:.2f}", name, right,
               images, median(mm), median(deg), images > 0 ? margin / images : 0, median(share_with));
    if (pairs > 0) {
      fmt::print("; without the object ({} images) {:.2f}, at most {:.2f}, pairs in order {:.3f}",
                 share_without.size(), median(share_without),
                 *std::max_element(share_without.begin(), share_without.end()), above / pairs);
    }
    fmt::print("\n");
  }
};

void try_image(const Candidate& c, const SearchFrame& frame, const FrameTables& tables, const BopImage& image,
               int object_id, double angle_tolerance_rad, Summary& summary) {
  const Constraint constraint(
      frame.camera, 0.35, 3.0,
      TableConstraint{*image.table, {0.0135, angle_tolerance_rad}, c.model.centre_height_m});
  const Landscape landscape(c, tables, constraint);
  std::vector<Hit> starts = landscape.starts(frame.camera, *image.table);
  std::vector<RigidTransform> truths;
  for (const BopGt& gt : image.ground_truth) {
    if (gt.object_id != object_id) continue;
    truths.push_back(gt.camera_from_mesh * c.model.object_from_mesh.inverse());
    Pose6 pose = pose_from_transform(frame.camera, truths.back());
    for (int turn = 0; turn < (c.model.symmetry_deg == 0 ? 1 : 360); turn += 15, pose.rz += 15 * kDegree)
      starts.push_back({Landscape::lattice_pose(pose), 0});
  }
  Hit best;
  Error best_error;
  double best_right = kLowest;
  double best_wrong = kLowest;
  for (const Hit& start : starts) {
    const Hit hit = landscape.climb(start.pose);
    if (hit.score == kLowest) continue;
    Error error;
    const RigidTransform found = transform_from_pose(frame.camera, pose_of(hit.pose));
    for (const RigidTransform& truth : truths) {
      const Error e = error_of(found, truth, c.model.symmetry_deg);
      if (e.mm < error.mm) error = e;
    }
    double& group = error.right() ? best_right : best_wrong;
    group = std::max(group, hit.score);
    if (hit.score > best.score) {
      best = hit;
      best_error = error;
    }
  }
  if (best.score == kLowest) return;
  const ScoredBin& bin = c.bins[static_cast<std::size_t>(best.pose.bin)];
  const double share = evidence_share(bin, best.score);
  if (truths.empty()) {
    summary.share_without.push_back(share);
    return;
  }
  ++summary.images;
  summary.right += best_error.right() ? 1 : 0;
  summary.mm.push_back(best_error.mm);
  summary.deg.push_back(best_error.deg);
  summary.share_with.push_back(share);
  if (best_right > kLowest && best_wrong > kLowest)
    summary.margin += (best_right - best_wrong) / (bin.offset - bin.zero);
}

struct Arguments {
  std::vector<std::string> sets, models;
  int object_id = -1;
  int images = 1000;
  double cut = 0;  ///< so much of the first object's box is left of the image
  double gain = 1, blur_px = 0, angle_tolerance_deg = 4;
  EdgeOptions edges = kFrameEdges;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto value = [&] {
      if (i + 1 >= words.size()) throw UsageError(words[i] + " needs a value");
      return words[++i];
    };
    if (words[i] == "-d") {
      a.sets = split(value(), ',');
    } else if (words[i] == "-o") {
      a.object_id = std::stoi(value());
    } else if (words[i] == "-n") {
      a.images = std::stoi(value());
    } else if (words[i] == "-t") {
      a.angle_tolerance_deg = std::stod(value());
    } else if (words[i] == "--gain") {
      a.gain = std::stod(value());
    } else if (words[i] == "--blur") {
      a.blur_px = std::stod(value());
    } else if (words[i] == "--cut") {
      a.cut = std::stod(value());
    } else if (words[i] == "--fixed-edges") {
      a.edges = {};
    } else {
      a.models.push_back(words[i]);
    }
  }
  if (a.sets.empty() || a.models.empty()) throw UsageError("give -d SET and models");
  return a;
}

/// Cuts the left of the image off, so that `share` of the object's box is outside.
void cut_left(RgbdFrame& frame, const BopImage& image, int object_id, double share) {
  for (const BopGt& gt : image.ground_truth) {
    if (gt.object_id != object_id || !gt.bbox) continue;
    const int most = static_cast<int>(0.6 * frame.colour.cols);  // the principal point must stay near
    const int at = std::clamp(static_cast<int>(gt.bbox->x + gt.bbox->width * share), 0, most);
    const cv::Rect rest(at, 0, frame.colour.cols - at, frame.colour.rows);
    frame.colour = frame.colour(rest).clone();
    frame.axial_depth_m = frame.axial_depth_m(rest).clone();
    frame.camera.width = rest.width;
    frame.camera.cx -= at;
    return;
  }
}

void run(const Arguments& a) {
  std::vector<Candidate> candidates;
  for (const std::string& text : a.models) candidates.emplace_back(text);
  std::vector<Summary> summaries(candidates.size());
  WorkerPool pool(1);
  FrameTables tables;
  for (const std::string& folder : a.sets) {
    const BopDataset set = open_bop_dataset(folder, "test");
    for (std::size_t i = 0; i < set.images.size() && i < static_cast<std::size_t>(a.images); ++i) {
      const BopImage& image = set.images[i];
      if (!image.table) continue;
      RgbdFrame raw = load_frame(image);
      if (a.cut > 0)
        cut_left(raw, image, a.object_id >= 0 ? a.object_id : candidates[0].model.object_id, a.cut);
      const SearchFrame frame = rectified(raw);
      cv::Mat colour = frame.colour * a.gain;
      if (a.blur_px > 0) cv::GaussianBlur(colour, colour, {}, a.blur_px);
      tables.build(frame, edges_by_direction(colour, a.edges), 40, pool);
      for (std::size_t k = 0; k < candidates.size(); ++k) {
        try_image(candidates[k], frame, tables, image,
                  a.object_id >= 0 ? a.object_id : candidates[k].model.object_id,
                  a.angle_tolerance_deg * kDegree, summaries[k]);
      }
    }
  }
  for (std::size_t k = 0; k < candidates.size(); ++k) summaries[k].print(candidates[k].name);
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  try {
    sextant::run(sextant::parse(argc, argv));
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
}
