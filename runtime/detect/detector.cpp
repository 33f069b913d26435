// SPDX-License-Identifier: Apache-2.0
#include "runtime/detect/detector.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <span>

#include "runtime/base/error.h"
#include "runtime/detect/answer_refiner.h"
#include "runtime/detect/most_certain.h"
#include "runtime/detect/outline_box.h"
#include "runtime/detect/resting_poses.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/frame/table_estimate.h"
#include "runtime/geometry/pose_mapping.h"
#include "runtime/refine/confidence.h"
#include "runtime/search/branch_and_bound.h"
#include "runtime/search/lanes/lane_search.h"
#include "runtime/search/reference/thesis_search.h"
#include "runtime/search/seeds.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// An answer that is less certain than this is more likely wrong than right: the next best place is looked
/// at.
constexpr double kDoubtful = 0.5;
/// Share of the doubtful answer's evidence that the next best place must reach.
constexpr double kWorthALook = 0.9;
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

}  // namespace

struct Detector::Impl {
  std::vector<ObjectModel> models;
  DetectOptions options;
  std::vector<SearchedObject> objects;
  std::vector<std::size_t> object_of;    ///< per model: the first model of the same object
  std::vector<FoundPose> lattice_poses;  ///< of the estimates of the frame at hand
  WorkerPool pool;
  AnswerRefiner answer_refiner;
  Rectifier rectifier;
  EdgeFinder edge_finder;
  FrameTables tables;
  LaneTables lane_tables;
  LaneSearch lane_search;

  Impl(std::vector<ObjectModel> m, DetectOptions o)
      : models(std::move(m)),
        options(std::move(o)),
        pool(options.threads),
        answer_refiner(models, pool),
        rectifier(options.search_width) {
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

  /// One object that this call looks for.
  struct SearchedModel {
    std::size_t index;
    double threshold;
    const Constraint* constraint;
    std::vector<Box2> taken{};  ///< by what was found already
  };

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
    const std::vector<SearchOutcome> outcomes = search(searched, call, search_start);
    lattice_poses.clear();
    for (const SearchedModel& s : searched) objects[s.index].last_found.clear();
    report_all(searched, frame, outcomes, most_found(call), result);
    result.seconds.search = seconds_since(search_start);
    if (call.searched) call.searched(record(prepared, searched, outcomes));

    if (options.refine) {
      const RefineFrame seen{rectified, edges, result.table, table ? table->tolerance : options.tolerance};
      const auto refine_start = Clock::now();
      refine_from(0, seen, frame, result);
      result.seconds.refine = seconds_since(refine_start);
      // Ranks would have to prepare the frame once more within the deadline.
      const bool can_look_further = options.bound != "thesis" && !(call.search && deadline_ms(call) > 0);
      for (int places = options.max_detections; can_look_further && places < options.candidates; ++places) {
        if (!look_further(seen, frame, searched, call, places, search_start, result)) break;
      }
      report_most_certain(result);
      leave_out_doubtful(result);
    }
    result.seconds.total = seconds_since(start);
    return result;
  }

  /// How many poses of each object a call is about.
  int most_found(const DetectCall& call) const { return call.further.empty() ? options.max_detections : 1; }

  std::vector<SearchOutcome> search(const std::vector<SearchedModel>& searched, const DetectCall& call,
                                    Clock::time_point start) {
    return options.bound == "lanes" ? search_together(searched, call, start)
                                    : search_in_turn(searched, call, start);
  }

  /// Adds what was found of all models, one answer for each place, to the result and lattice_poses.
  void report_all(const std::vector<SearchedModel>& searched, const RgbdFrame& frame,
                  const std::vector<SearchOutcome>& outcomes, int most, FrameResult& result) {
    const std::size_t before = result.estimates.size();
    const std::size_t outcomes_before = result.objects.size();
    for (std::size_t i = 0; i < searched.size(); ++i) report(searched[i], frame, outcomes[i], result);
    merge_resting_poses(before, outcomes_before, most, result);
  }

  /// Where as many places as given are known of an object, its search is over and what would be reported is
  /// doubtful: adds its next best place, refined. False: there is no more to look for, or no time.
  bool look_further(const RefineFrame& seen, const RgbdFrame& frame,
                    const std::vector<SearchedModel>& searched, const DetectCall& call, int places,
                    Clock::time_point search_start, FrameResult& result) {
    std::map<std::size_t, double> floors;  // by object
    for (const SearchedModel& s : searched) {
      const std::size_t object = object_of[s.index];
      if (!floors.contains(object)) floors[object] = floor_of_next(object, places, result);
    }
    DetectCall further = call;
    std::vector<SearchedModel> again;
    for (const SearchedModel& s : searched) {
      const double floor = floors[object_of[s.index]];
      if (std::isinf(floor)) continue;
      again.push_back(
          {s.index, std::max(s.threshold, floor), s.constraint, places_of(object_of[s.index], result)});
      further.further.push_back({s.index, again.back().threshold, again.back().taken});
    }
    if (again.empty()) return false;
    const auto expired = expiry(call, search_start, 1);
    if (expired && expired()) return false;

    const auto start = Clock::now();
    const std::vector<SearchOutcome> outcomes = search(again, further, search_start);
    const std::size_t before = result.estimates.size();
    const std::vector<ObjectOutcome> claims = result.objects;  // the further ones are about the rest
    report_all(again, frame, outcomes, 1, result);
    result.objects = claims;
    for (std::size_t i = before; i < result.estimates.size(); ++i)
      cap_by_first_search(result.estimates[i], claims);
    const auto refine_start = Clock::now();
    result.seconds.search += std::chrono::duration<double>(refine_start - start).count();
    refine_from(before, seen, frame, result);
    result.seconds.refine += seconds_since(refine_start);
    return result.estimates.size() > before &&
           std::all_of(outcomes.begin(), outcomes.end(), [](const SearchOutcome& o) { return o.complete; });
  }

  /// What the first search proved of all poses beside the first places holds for a further place as well.
  static void cap_by_first_search(PoseEstimate& e, const std::vector<ObjectOutcome>& claims) {
    for (const ObjectOutcome& claim : claims) {
      if (claim.model_index != e.model_index) continue;
      e.upper_bound = std::min(e.upper_bound, std::max(claim.upper_bound, e.log_score));
      e.gap = std::max(0.0, e.upper_bound - e.log_score);
    }
  }

  /// What the next place of an object must score to be worth a look; infinity: what would be reported is not
  /// doubtful, or there is no more to find.
  double floor_of_next(std::size_t object, int places, const FrameResult& result) const {
    constexpr double kNowhere = std::numeric_limits<double>::infinity();
    for (const ObjectOutcome& o : result.objects) {
      if (object_of[o.model_index] == object && o.status == SearchStatus::kBounded) return kNowhere;
    }
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < result.estimates.size(); ++i) {
      if (object_of[result.estimates[i].model_index] == object) known.push_back(i);
    }
    if (static_cast<int>(known.size()) != places) return kNowhere;
    std::stable_sort(known.begin(), known.end(), [&](std::size_t a, std::size_t b) {
      return result.estimates[a].score > result.estimates[b].score;
    });
    known.resize(std::min(known.size(), static_cast<std::size_t>(options.max_detections)));
    double floor = kNowhere;
    for (const std::size_t i : known) {
      if (result.estimates[i].score >= kDoubtful) continue;
      const FoundPose& f = lattice_poses[i];
      const double zero = (*f.bins)[static_cast<std::size_t>(f.pose.bin)].zero;
      floor = std::min(floor, zero + kWorthALook * (f.score - zero));
    }
    return floor;
  }

  /// The boxes of what was found of an object.
  std::vector<Box2> places_of(std::size_t object, const FrameResult& result) const {
    std::vector<Box2> boxes;
    for (std::size_t i = 0; i < result.estimates.size(); ++i) {
      const std::size_t model = result.estimates[i].model_index;
      if (object_of[model] != object) continue;
      const FoundPose& f = lattice_poses[i];
      boxes.push_back(
          box_of((*f.bins)[static_cast<std::size_t>(f.pose.bin)], f.constraint->camera().focal, f.pose));
    }
    return boxes;
  }

  /// Models of the same object are its resting poses: one answer for each place. Of what one search reported:
  /// estimates and outcomes from the given ones on.
  void merge_resting_poses(std::size_t first, std::size_t first_outcome, int most, FrameResult& result) {
    std::map<std::size_t, std::vector<RestingBound>> bounds_of;  // by object
    for (std::size_t i = first_outcome; i < result.objects.size(); ++i) {
      const ObjectOutcome& o = result.objects[i];
      bounds_of[object_of[o.model_index]].push_back({o.model_index, o.upper_bound});
    }
    std::vector<PoseEstimate> estimates(result.estimates.begin(),
                                        result.estimates.begin() + static_cast<std::ptrdiff_t>(first));
    std::vector<FoundPose> found(lattice_poses.begin(),
                                 lattice_poses.begin() + static_cast<std::ptrdiff_t>(first));
    std::set<std::size_t> merged;
    for (std::size_t i = first; i < result.estimates.size(); ++i) {
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
      for (const RestingChoice& choice : one_per_place(answers, bounds, most)) {
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

  /// Refines the estimates from the given one on.
  void refine_from(std::size_t first, const RefineFrame& seen, const RgbdFrame& frame, FrameResult& result) {
    answer_refiner.refine(seen, frame.camera, tables, std::span(lattice_poses).subspan(first),
                          std::span(result.estimates).subspan(first));
  }

  /// Of the places that were looked at, those that are reported: by object, best first. What is known of the
  /// objects then speaks of the others, too.
  void report_most_certain(FrameResult& result) const {
    std::vector<double> found;
    for (const FoundPose& f : lattice_poses) found.push_back(f.score);
    std::vector<std::size_t> kept =
        keep_most_certain(result.estimates, found, object_of, options.max_detections);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (std::binary_search(kept.begin(), kept.end(), i)) continue;
      for (ObjectOutcome& o : result.objects) {
        if (object_of[o.model_index] == object_of[result.estimates[i].model_index])
          o.upper_bound = std::max(o.upper_bound, found[i]);
      }
    }
    std::stable_sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) {
      const std::size_t first = object_of[result.estimates[a].model_index];
      const std::size_t second = object_of[result.estimates[b].model_index];
      return first != second ? first < second : found[a] > found[b];
    });
    std::vector<PoseEstimate> reported;
    reported.reserve(kept.size());
    for (const std::size_t i : kept) reported.push_back(std::move(result.estimates[i]));
    result.estimates = std::move(reported);
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

  std::vector<SearchedModel> searched_models(const DetectCall& call,
                                             const std::vector<Constraint>& constraints) {
    std::vector<SearchedModel> searched;
    for (const FurtherPlace& place : call.further) {
      searched.push_back({place.model, place.threshold, &constraints.at(place.model), place.taken});
    }
    for (std::size_t i = 0; call.further.empty() && i < models.size(); ++i) {
      if (call.wanted && !call.wanted(models[i].name)) continue;
      const auto threshold = call.thresholds.find(models[i].name);
      searched.push_back({i, threshold == call.thresholds.end() ? objects[i].threshold : threshold->second,
                          &constraints[i]});
    }
    for (const SearchedModel& s : searched) objects[s.index].prepare_for(s.threshold);
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

  double deadline_ms(const DetectCall& call) const { return call.deadline_ms.value_or(options.deadline_ms); }

  /// True when the time is over or the caller wants no more; empty where neither can happen.
  std::function<bool()> expiry(const DetectCall& call, Clock::time_point start, double share) const {
    if (!(deadline_ms(call) > 0)) return call.stop;
    const double left_ms = (deadline_ms(call) - 1e3 * seconds_since(start)) * share;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double, std::milli>(left_ms));
    return [end, &call] { return Clock::now() >= end || (call.stop && call.stop()); };
  }

  /// What counts as another explanation of an object; empty where nobody asks.
  std::optional<RunnerUpOptions> runner_up(std::size_t model, const DetectCall& call) const {
    if (!options.runner_up || !call.further.empty()) return std::nullopt;
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
                                 models[s.index].bounding_radius_m, most_found(call), s.threshold,
                                 runner_up(s.index, call),
                                 call.further.empty() ? seeds(s) : std::vector<LatticePose>{}, s.taken});
    }
    return call.search ? call.search(problem, call) : lane_search.run(problem, pool);
  }

  /// The plain searches, one object after the other; each gets its share of the time that is left.
  std::vector<SearchOutcome> search_in_turn(const std::vector<SearchedModel>& searched,
                                            const DetectCall& call, Clock::time_point start) {
    std::vector<SearchOutcome> outcomes;
    for (const SearchedModel& s : searched) {
      SearchOptions search_options;
      search_options.max_detections = most_found(call);
      search_options.excluded.boxes = s.taken;
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
      if (const auto rivals = runner_up(s.index, call); rivals && outcomes.back().complete) {
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
      lattice_poses.push_back({found.pose, found.score, &object.bins, searched.constraint});
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
