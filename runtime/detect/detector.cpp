// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/detector.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "runtime/base/error.h"
#include "runtime/detect/most_certain.h"
#include "runtime/detect/resting_poses.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/frame/table_estimate.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/refine/confidence.h"
#include "runtime/refine/refiner.h"
#include "runtime/search/branch_and_bound.h"
#include "runtime/search/lanes/lane_search.h"
#include "runtime/search/other_turns.h"
#include "runtime/search/reference/thesis_search.h"
#include "runtime/search/seeds.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Share of the evidence by which another turn may score less and still be tried.
constexpr double kNearlyAsGood = 0.1;
constexpr std::size_t kMostOtherTurns = 3;
/// Share of the pixels in which two turns differ that another turn must explain better.
constexpr double kClearlyBetter = 0.1;

/// The lattice pose behind an estimate.
struct FoundPose {
  LatticePose pose;
  double score = 0;
  const Constraint* constraint = nullptr;
};

/// A model under the chosen scoring.
struct SearchedObject {
  std::vector<ScoredBin> bins;
  std::vector<LaneBin> lane_bins;  ///< for scores from `floor` up
  double floor = std::numeric_limits<double>::infinity();
  double threshold = 0;
  double largest_visual_radius = 0;
  std::vector<LatticePose> last_found;  ///< in the last frame that was searched for it

  void prepare_for(double score) {
    if (score == floor) return;
    floor = score;
    lane_bins.clear();
    for (const ScoredBin& bin : bins) lane_bins.push_back(lane_bin(bin, floor));
  }
};

void check(const DetectOptions& o) {
  if (o.max_detections < 1 || o.max_detections > 100) throw UsageError("max detections must be 1..100");
  if (o.candidates < 1 || o.candidates > 100) throw UsageError("candidates must be 1..100");
  if (o.threads < 0 || o.threads > 256) throw UsageError("threads must be 0..256 (0: all cores)");
  if (!(o.deadline_ms >= 0)) throw UsageError("the deadline must be >= 0 ms (0: none)");
  if (!(o.min_distance_m > 0.05) || !(o.max_distance_m > o.min_distance_m) || o.max_distance_m > 60) {
    throw UsageError("distances must satisfy 0.05 < min < max <= 60 m");
  }
  if (!(o.false_positive_rate > 0 && o.false_positive_rate <= 1)) {
    throw UsageError("the false-positive rate must be above 0, at most 1 (1: report all)");
  }
  if (o.search_width != 0 && (o.search_width < 64 || o.search_width > 4096)) {
    throw UsageError("the search width must be 64..4096 pixels (0: the frame's)");
  }
  if (!(o.runner_up_radius_m >= 0) || !(o.runner_up_angle_rad >= 0 && o.runner_up_angle_rad <= 3.15) ||
      !(o.runner_up_most > 0)) {
    throw UsageError("the runner-up's ball must have a radius >= 0 m and 0..180 deg, its margin be above 0");
  }
  if (o.bound != "lanes" && o.bound != "window" && o.bound != "thesis") {
    throw UsageError("no bound is called \"" + o.bound + "\"", "use lanes, window or thesis");
  }
}

/// Resting poses of one object: the same mesh and the same id. The id alone is not enough: it is 1 where
/// nobody gave one.
bool is_same_object(const ObjectModel& a, const ObjectModel& b) {
  return a.object_id == b.object_id && a.provenance.mesh_hash == b.provenance.mesh_hash;
}

/// Pixel box of the object's outline in the source image: x, y, width, height.
std::array<double, 4> outline_box(const ObjectModel& model, const CameraModel& camera,
                                  const RigidTransform& camera_from_object) {
  double x0 = std::numeric_limits<double>::infinity();
  double y0 = x0;
  double x1 = -x0;
  double y1 = -x0;
  for (const Eigen::Vector3f& v : model.mesh.vertices) {
    const Eigen::Vector3d p = camera_from_object * v.cast<double>();
    if (p.z() <= 1e-3) continue;
    const Eigen::Vector2d pixel = camera.distorted_pixel({p.x() / p.z(), p.y() / p.z()});
    x0 = std::min(x0, pixel.x());
    x1 = std::max(x1, pixel.x());
    y0 = std::min(y0, pixel.y());
    y1 = std::max(y1, pixel.y());
  }
  if (x0 > x1) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace

struct Detector::Impl {
  std::vector<ObjectModel> models;
  DetectOptions options;
  std::vector<SearchedObject> objects;
  std::vector<std::size_t> object_of;    ///< per model: the first model of the same object
  std::vector<Refiner> refiners;         ///< one per model
  std::vector<FoundPose> lattice_poses;  ///< of the estimates of the frame at hand
  WorkerPool pool;
  Rectifier rectifier;
  EdgeFinder edge_finder;
  FrameTables tables;
  LaneTables lane_tables;
  LaneSearch lane_search;

  Impl(std::vector<ObjectModel> m, DetectOptions o)
      : models(std::move(m)), options(std::move(o)), pool(options.threads), rectifier(options.search_width) {
    check(options);
    if (models.empty()) throw UsageError("no model to look for", "give at least one compiled model");
    const Scoring scoring = scoring_from_name(options.scoring);
    for (const ObjectModel& model : models) {
      SearchedObject object;
      object.bins = score_bins(model, scoring);
      object.threshold = options.threshold.value_or(default_threshold(object.bins));
      for (const ScoredBin& bin : object.bins) {
        object.largest_visual_radius =
            std::max(object.largest_visual_radius, double{bin.largest_visual_radius});
      }
      object.prepare_for(object.threshold);
      objects.push_back(std::move(object));
      refiners.emplace_back(model);
      const auto same = std::find_if(models.begin(), models.end(),
                                     [&](const ObjectModel& other) { return is_same_object(other, model); });
      object_of.push_back(static_cast<std::size_t>(same - models.begin()));
    }
  }

  /// The table, with the tolerance of the search widened by what is not known of it.
  struct SearchedTable {
    TableGeometry table;
    TableTolerance tolerance;
  };

  std::optional<SearchedTable> table_for(const RgbdFrame& frame, const SearchFrame& rectified) const {
    const std::string where = "image " + std::to_string(frame.image_id);
    switch (options.table) {
      case TableSource::kNone:
        return std::nullopt;
      case TableSource::kFixed:
        return SearchedTable{options.fixed_table, options.tolerance};
      case TableSource::kFrame:
        if (!frame.table) {
          throw InputError(where, "the frame does not say where the table is",
                           "add scene_table.json, or use a table estimate, fixed values, or none");
        }
        return SearchedTable{
            *frame.table, widened(options.tolerance, frame.table_uncertainty.value_or(TableUncertainty{}))};
      case TableSource::kEstimate: {
        const auto estimate = estimate_table(rectified);
        if (!estimate) throw InputError(where, "no table", estimate.error().reason);
        return SearchedTable{estimate->table, widened(options.tolerance, estimate->uncertainty)};
      }
    }
    return std::nullopt;
  }

  /// Pixels beyond which no part feels a feature, at the nearest distance at which an object can be.
  int clip_radius(const PinholeCamera& camera, const std::vector<Constraint>& constraints) const {
    double pixels = 0;
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const double nearest = constraints[i].nearest_feasible_distance();
      pixels = std::max(pixels, std::ceil(objects[i].largest_visual_radius * camera.focal / nearest) + 1);
    }
    return static_cast<int>(std::clamp(pixels, 2.0, 200.0));
  }

  /// What the search of a frame starts from.
  struct PreparedFrame {
    SearchFrame rectified;
    cv::Mat edges;
    std::optional<SearchedTable> table;
    std::vector<Constraint> constraints;  ///< one per model
    int clip = 1;                         ///< of the tables, pixels
  };

  PreparedFrame prepare(const RgbdFrame& frame, const DetectCall& call) {
    PreparedFrame out;
    out.rectified = rectifier.rectified(frame);
    out.edges = edge_finder.edges_by_direction(out.rectified.colour, kFrameEdges);
    out.table = table_for(frame, out.rectified);
    RegionOfInterest wanted = options.region;
    if (call.image_region) wanted.image = call.image_region;
    const SearchRegion region = search_region(wanted, frame.camera, out.rectified.camera,
                                              out.table ? std::optional(out.table->table) : std::nullopt);
    for (const ObjectModel& model : models) {
      std::optional<TableConstraint> standing;
      if (out.table)
        standing = TableConstraint{out.table->table, out.table->tolerance, model.centre_height_m};
      out.constraints.emplace_back(out.rectified.camera, options.min_distance_m, options.max_distance_m,
                                   standing, region);
    }
    out.clip = clip_radius(out.rectified.camera, out.constraints);
    return out;
  }

  FrameResult detect(const RgbdFrame& frame, const DetectCall& call) {
    FrameResult result;
    result.captured_at = frame.captured_at;
    result.frame_id = frame.frame_id;
    result.sequence = frame.sequence;
    result.scene_id = frame.scene_id;
    result.image_id = frame.image_id;

    const auto start = Clock::now();
    const PreparedFrame prepared = prepare(frame, call);
    const auto& [rectified, edges, table, constraints, clip] = prepared;
    result.seconds.features = seconds_since(start);
    if (table) result.table = table->table;
    result.table_origin = options.table == TableSource::kEstimate ? TableProvenance::kEstimate
                          : options.table == TableSource::kFixed  ? TableProvenance::kFixed
                                                                  : TableProvenance::kFrame;

    const auto tables_start = Clock::now();
    const bool lanes = options.bound == "lanes";
    tables.build(rectified, edges, clip, pool, !lanes);
    if (lanes) lane_tables.build(tables, pool);
    result.seconds.tables = seconds_since(tables_start);

    const auto search_start = Clock::now();
    const std::vector<SearchedModel> searched = searched_models(call, constraints);
    if (searched.empty()) return result;
    const std::vector<SearchOutcome> outcomes =
        lanes ? search_together(searched, call, search_start) : search_in_turn(searched, call, search_start);
    lattice_poses.clear();
    for (std::size_t i = 0; i < searched.size(); ++i) report(searched[i], frame, outcomes[i], result);
    merge_resting_poses(result);
    result.seconds.search = seconds_since(search_start);
    if (call.searched) call.searched(record(prepared, searched, outcomes));

    if (options.refine) {
      const auto refine_start = Clock::now();
      const RefineFrame seen{rectified, edges, result.table, table ? table->tolerance : options.tolerance};
      for (std::size_t i = 0; i < result.estimates.size(); ++i) {
        refine(seen, frame, result.estimates[i]);
        try_other_turns(seen, frame, lattice_poses[i], result.estimates[i]);
      }
      report_most_certain(result);
      leave_out_doubtful(result);
      result.seconds.refine = seconds_since(refine_start);
    } else {
      report_most_certain(result);
    }
    result.seconds.total = seconds_since(start);
    return result;
  }

  /// Models of the same object are its resting poses: one answer for each place.
  void merge_resting_poses(FrameResult& result) {
    std::map<std::size_t, std::vector<RestingBound>> bounds_of;  // by object
    for (const ObjectOutcome& o : result.objects) {
      bounds_of[object_of[o.model_index]].push_back({o.model_index, o.upper_bound});
    }
    std::vector<PoseEstimate> estimates;
    std::vector<FoundPose> found;
    std::set<std::size_t> merged;
    for (std::size_t i = 0; i < result.estimates.size(); ++i) {
      const std::size_t object = object_of[result.estimates[i].model_index];
      const std::vector<RestingBound>& bounds = bounds_of[object];
      if (bounds.size() < 2) {
        estimates.push_back(result.estimates[i]);
        found.push_back(lattice_poses[i]);
        continue;
      }
      if (!merged.insert(object).second) continue;
      std::vector<std::size_t> of_object;
      std::vector<RestingAnswer> answers;
      for (std::size_t k = i; k < result.estimates.size(); ++k) {
        const PoseEstimate& e = result.estimates[k];
        if (object_of[e.model_index] != object) continue;
        const FoundPose& f = lattice_poses[k];
        const ScoredBin& bin = objects[e.model_index].bins[static_cast<std::size_t>(f.pose.bin)];
        of_object.push_back(k);
        answers.push_back({e.model_index, f.score, box_of(bin, f.constraint->camera().focal, f.pose)});
      }
      for (const RestingChoice& choice : one_per_place(answers, bounds, searched_detections(options))) {
        const std::size_t k = of_object[choice.answer];
        PoseEstimate e = result.estimates[k];
        e.upper_bound = choice.upper_bound;
        e.gap = std::max(0.0, e.upper_bound - e.log_score);
        if (e.gap > 0) e.status = SearchStatus::kBounded;
        const double margin = std::max(0.0, e.log_score - choice.rival);
        if (options.runner_up && margin < e.runner_up_margin) {
          e.runner_up_margin = margin;
          e.runner_up_exact = choice.rival_exact;
        }
        estimates.push_back(std::move(e));
        found.push_back(lattice_poses[k]);
      }
    }
    result.estimates = std::move(estimates);
    lattice_poses = std::move(found);
  }

  /// Replaces a lattice pose by the continuous one.
  void refine(const RefineFrame& seen, const RgbdFrame& frame, PoseEstimate& estimate) {
    const ObjectModel& model = models[estimate.model_index];
    const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
    const RefinedPose refined =
        refiners[estimate.model_index].refine(seen, estimate.camera_from_object * mesh_from_object);
    estimate.camera_from_object = refined.camera_from_object * model.object_from_mesh;
    const Eigen::Vector3d offset =
        estimate.camera_from_object.translation() - refined.camera_from_object.translation();
    estimate.covariance = moved_covariance(with_model_error(refined.covariance), offset);
    estimate.refinement = refined.quality;
    estimate.score = confidence(model.confidence, confidence_features(estimate));
    estimate.bbox = outline_box(model, frame.camera, refined.camera_from_object);
  }

  /// Where the score hardly tells which way an object is turned, the rigid model may: it sees every pixel.
  /// What is chosen so is no longer the optimum of the score, and its certificate says by how much.
  void try_other_turns(const RefineFrame& seen, const RgbdFrame& frame, const FoundPose& found,
                       PoseEstimate& estimate) {
    const ObjectModel& model = models[estimate.model_index];
    const RigidTransform mesh_from_object = model.object_from_mesh.inverse();
    const std::vector<ScoredBin>& bins = objects[estimate.model_index].bins;
    const ScoredBin& bin = bins[static_cast<std::size_t>(found.pose.bin)];
    const SearchProblem problem{bins, tables, *found.constraint, model.bounding_radius_m};
    const double least = found.score - kNearlyAsGood * (bin.offset - bin.zero);
    const double upper_bound = std::max(estimate.upper_bound, estimate.log_score);
    for (const ScoredPose& other :
         other_turns(problem, found.pose, model.symmetry_deg, least, kMostOtherTurns)) {
      PoseEstimate turned = estimate;
      turned.camera_from_object =
          transform_from_pose(found.constraint->camera(), pose_of(other.pose)) * model.object_from_mesh;
      turned.log_score = other.score;
      turned.evidence_share = evidence_share(bins[static_cast<std::size_t>(other.pose.bin)], other.score);
      turned.upper_bound = upper_bound;
      turned.gap = std::max(0.0, upper_bound - other.score);
      turned.status = turned.gap == 0 ? estimate.status : SearchStatus::kBounded;
      turned.runner_up_margin = 0;
      turned.runner_up_exact = false;
      refine(seen, frame, turned);
      turned.refinement.other_turn = true;
      const double better = refiners[estimate.model_index].compare(
          seen, estimate.camera_from_object * mesh_from_object, turned.camera_from_object * mesh_from_object);
      // Where the shape is the same either way, the print and the outline tell.
      if (better > kClearlyBetter || (better == 0 && turned.score > estimate.score)) estimate = turned;
    }
  }

  void report_most_certain(FrameResult& result) const {
    if (options.candidates <= options.max_detections) return;
    std::vector<PoseEstimate> kept;
    for (const std::size_t i : keep_most_certain(result.estimates, object_of, options.max_detections)) {
      kept.push_back(std::move(result.estimates[i]));
    }
    result.estimates = std::move(kept);
  }

  /// Leaves out what is less certain than the wanted false-positive rate allows.
  void leave_out_doubtful(FrameResult& result) const {
    for (ObjectOutcome& outcome : result.objects) {
      const std::size_t i = outcome.model_index;
      outcome.least_confidence =
          threshold_for_false_positive_rate(models[i].confidence, options.false_positive_rate);
      outcome.doubtful = static_cast<int>(std::erase_if(result.estimates, [&](const PoseEstimate& e) {
        return e.model_index == i && e.score < outcome.least_confidence;
      }));
    }
  }

  /// One object that this call looks for.
  struct SearchedModel {
    std::size_t index;
    double threshold;
    const Constraint* constraint;
  };

  std::vector<SearchedModel> searched_models(const DetectCall& call,
                                             const std::vector<Constraint>& constraints) {
    std::vector<SearchedModel> searched;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (call.wanted && !call.wanted(models[i].name)) continue;
      const auto threshold = call.thresholds.find(models[i].name);
      searched.push_back({i, threshold == call.thresholds.end() ? objects[i].threshold : threshold->second,
                          &constraints[i]});
      objects[i].prepare_for(searched.back().threshold);
    }
    return searched;
  }

  SearchRecord record(const PreparedFrame& prepared, const std::vector<SearchedModel>& searched,
                      const std::vector<SearchOutcome>& outcomes) const {
    SearchRecord out{prepared.rectified, prepared.edges, prepared.clip, {}, options.tolerance, {}};
    if (prepared.table) {
      out.table = prepared.table->table;
      out.tolerance = prepared.table->tolerance;
    }
    for (std::size_t i = 0; i < searched.size(); ++i) {
      const SearchedModel& s = searched[i];
      out.objects.push_back({s.index, objects[s.index].bins, *s.constraint, s.threshold,
                             outcomes.empty() ? SearchOutcome{} : outcomes[i]});
    }
    return out;
  }

  /// True when the time is over or the caller wants no more; empty where neither can happen.
  std::function<bool()> expiry(const DetectCall& call, Clock::time_point start, double share) const {
    const double deadline_ms = call.deadline_ms.value_or(options.deadline_ms);
    if (!(deadline_ms > 0)) return call.stop;
    const double left_ms = (deadline_ms - 1e3 * seconds_since(start)) * share;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double, std::milli>(left_ms));
    return [end, &call] { return Clock::now() >= end || (call.stop && call.stop()); };
  }

  /// What counts as another explanation of an object; empty where nobody asks.
  std::optional<RunnerUpOptions> runner_up(std::size_t model) const {
    if (!options.runner_up) return std::nullopt;
    return RunnerUpOptions{
        {options.runner_up_radius_m, options.runner_up_angle_rad, models[model].symmetry_deg},
        options.runner_up_most};
  }

  /// The last frame's poses of an object, moved to the best pose near them in this frame.
  std::vector<LatticePose> seeds(const SearchedModel& s) const {
    std::vector<LatticePose> out;
    if (!options.warm_start) return out;
    const SearchProblem problem{objects[s.index].bins, tables, *s.constraint,
                                models[s.index].bounding_radius_m};
    for (const LatticePose& last : objects[s.index].last_found) {
      if (const auto pose = climbed(problem, last)) out.push_back(pose->pose);
    }
    return out;
  }

  /// All objects in one search under one deadline, best bound first.
  std::vector<SearchOutcome> search_together(const std::vector<SearchedModel>& searched,
                                             const DetectCall& call, Clock::time_point start) {
    LaneSearchProblem problem{tables, lane_tables, {}, expiry(call, start, 1)};
    for (const SearchedModel& s : searched) {
      problem.targets.push_back({objects[s.index].bins, objects[s.index].lane_bins, *s.constraint,
                                 models[s.index].bounding_radius_m, searched_detections(options), s.threshold,
                                 runner_up(s.index), seeds(s)});
    }
    return call.search ? call.search(problem) : lane_search.run(problem, pool);
  }

  /// The plain searches, one object after the other; each gets its share of the time that is left.
  std::vector<SearchOutcome> search_in_turn(const std::vector<SearchedModel>& searched,
                                            const DetectCall& call, Clock::time_point start) {
    std::vector<SearchOutcome> outcomes;
    for (const SearchedModel& s : searched) {
      SearchOptions search_options;
      search_options.max_detections = searched_detections(options);
      search_options.threshold = s.threshold;
      search_options.expired =
          expiry(call, start, 1 / static_cast<double>(searched.size() - outcomes.size()));
      const SearchProblem problem{objects[s.index].bins, tables, *s.constraint,
                                  models[s.index].bounding_radius_m};
      if (options.bound == "thesis") {
        outcomes.push_back(thesis_search(problem, search_options));
        continue;
      }
      outcomes.push_back(branch_and_bound(problem, search_options, pool));
      if (const auto rivals = runner_up(s.index); rivals && outcomes.back().complete) {
        outcomes.back().runner_ups =
            plain_runner_ups(problem, outcomes.back().found, search_options, *rivals, pool);
      }
    }
    return outcomes;
  }

  void report(const SearchedModel& searched, const RgbdFrame& frame, const SearchOutcome& outcome,
              FrameResult& result) {
    const std::size_t index = searched.index;
    const ObjectModel& model = models[index];
    const SearchedObject& object = objects[index];
    const PinholeCamera& camera = searched.constraint->camera();
    result.nodes += outcome.nodes;

    objects[index].last_found.clear();
    for (const ScoredPose& found : outcome.found) objects[index].last_found.push_back(found.pose);

    ObjectOutcome summary;
    summary.model_index = index;
    summary.object_id = model.object_id;
    summary.object_name = model.name;
    summary.upper_bound = outcome.upper_bound;
    summary.threshold = searched.threshold;
    summary.coverage = searched.constraint->coverage(model.bins);
    summary.status = !outcome.complete       ? SearchStatus::kBounded
                     : outcome.found.empty() ? SearchStatus::kAbsent
                                             : SearchStatus::kOptimal;
    for (std::size_t i = 0; i < outcome.found.size(); ++i) {
      const ScoredPose& found = outcome.found[i];
      const RigidTransform camera_from_object = transform_from_pose(camera, pose_of(found.pose));
      PoseEstimate e;
      e.model_index = index;
      e.object_id = model.object_id;
      e.object_name = model.name;
      e.camera_from_object = camera_from_object * model.object_from_mesh;
      e.log_score = found.score;
      e.evidence_share = evidence_share(object.bins[static_cast<std::size_t>(found.pose.bin)], found.score);
      e.score = e.evidence_share;
      e.upper_bound = outcome.upper_bound;
      e.gap = std::max(0.0, outcome.upper_bound - found.score);
      e.status = outcome.complete || e.gap == 0 ? SearchStatus::kOptimal : SearchStatus::kBounded;
      if (i < outcome.runner_ups.size()) {
        e.runner_up_margin = std::max(0.0, found.score - outcome.runner_ups[i].score);
        e.runner_up_exact = outcome.runner_ups[i].exact;
      }
      e.bbox = outline_box(model, frame.camera, camera_from_object);
      lattice_poses.push_back({found.pose, found.score, searched.constraint});
      result.estimates.push_back(std::move(e));
    }
    result.objects.push_back(std::move(summary));
  }
};

Detector::Detector(std::vector<ObjectModel> models, DetectOptions options)
    : impl_(std::make_unique<Impl>(std::move(models), std::move(options))) {}
Detector::~Detector() = default;
FrameResult Detector::detect(const RgbdFrame& frame, const DetectCall& call) {
  return impl_->detect(frame, call);
}
void Detector::prepare(const RgbdFrame& frame, const std::function<void(const SearchRecord&)>& visit) {
  const Impl::PreparedFrame prepared = impl_->prepare(frame, {});
  visit(impl_->record(prepared, impl_->searched_models({}, prepared.constraints), {}));
}
const std::vector<ObjectModel>& Detector::models() const { return impl_->models; }
const DetectOptions& Detector::options() const { return impl_->options; }

}  // namespace sextant
