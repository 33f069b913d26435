// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <set>

#include "offline/evaluate/average_precision.h"
#include "offline/evaluate/bop_error.h"
#include "offline/evaluate/point_error.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr double kRadian = 180 / std::numbers::pi;
constexpr double kAddShare = 0.1;  ///< of the diameter: the usual limit of ADD

using ImageKey = std::pair<int, int>;  ///< scene, image

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

bool ignored(const BopImage& image, const BopGt& gt, const EvaluatedObject& object,
             const EvaluationOptions& options) {
  if (gt.visible_fraction.value_or(1) < options.min_visible) return true;
  if (!options.upright_only) return false;
  if (!image.table) return true;
  const double cosine =
      (gt.camera_from_mesh.linear() * object.up.normalized()).dot(image.table->up_in_camera);
  return cosine < std::cos(options.upright_tolerance_deg / kRadian);
}

/// Box around the projected mesh; nothing where it reaches behind the camera or there is no mesh.
std::optional<cv::Rect2d> box_of(const EvaluatedObject& object, const CameraModel& camera,
                                 const RigidTransform& pose) {
  if (object.points.empty()) return std::nullopt;
  Eigen::Vector2d lo(1e9, 1e9);
  Eigen::Vector2d hi(-1e9, -1e9);
  for (const Eigen::Vector3d& p : object.points) {
    const Eigen::Vector3d q = pose * p;
    if (q.z() < 0.01) return std::nullopt;
    const Eigen::Vector2d pixel = camera.distorted_pixel(q.head<2>() / q.z());
    lo = lo.cwiseMin(pixel);
    hi = hi.cwiseMax(pixel);
  }
  return cv::Rect2d(lo.x(), lo.y(), hi.x() - lo.x(), hi.y() - lo.y());
}

double overlap(const std::optional<cv::Rect2d>& a, const std::optional<cv::Rect2d>& b) {
  if (!a || !b) return 0;
  const double both = (*a & *b).area();
  return both > 0 ? both / (a->area() + b->area() - both) : 0;
}

/// Everything about one object while the images go by.
struct Tally {
  ObjectReport report;
  std::vector<double> translations, rotations;
  std::vector<ScoredHit> boxes, answers;
  int within_translation = 0, within_rotation = 0, within_add = 0;
  bool has_add = false;
};

class Evaluator {
 public:
  Evaluator(const std::map<int, EvaluatedObject>& objects, const EvaluationOptions& options)
      : objects_(objects), options_(options) {
    report_.options = options;
    for (const auto& [id, object] : objects) {
      tallies_[id].report.name = fmt::format("object {}", id);
      tallies_[id].has_add = !object.points.empty() && object.diameter_m > 0;
      symmetries_[id] = symmetry_transforms(object.symmetry, object.centre_m);
    }
  }

  void add(const BopImage& image, const std::vector<BopResult>& results) {
    ++report_.images;
    for (const auto& [id, object] : objects_) add_object(image, id, object, results);
    add_confusion(image, results);
  }

  EvaluationReport finish() {
    Tally total;
    total.report.name = "all";
    bool boxes = true;
    for (auto& [id, tally] : tallies_) {
      boxes = boxes && !objects_.at(id).points.empty();
      total.has_add = total.has_add || tally.has_add;
      add_up(total, tally);
      report_.objects[id] = closed(tally, !objects_.at(id).points.empty());
      add_recalls(report_.objects[id], id);
    }
    report_.total = closed(total, boxes && !tallies_.empty());
    add_recalls(report_.total, -1);
    return std::move(report_);
  }

 private:
  void add_object(const BopImage& image, int id, const EvaluatedObject& object,
                  const std::vector<BopResult>& results) {
    Tally& tally = tallies_[id];
    std::vector<const BopGt*> truths;
    for (const BopGt& gt : image.ground_truth) {
      if (gt.object_id == id) truths.push_back(&gt);
    }
    std::vector<const BopResult*> detections;
    for (const BopResult& result : results) {
      if (result.object_id == id) detections.push_back(&result);
    }
    std::stable_sort(detections.begin(), detections.end(),
                     [](const BopResult* a, const BopResult* b) { return a->score > b->score; });
    if (truths.empty()) {
      ++tally.report.false_images;
      tally.report.false_detections += static_cast<int>(detections.size());
    }
    match_poses(image, id, object, truths, detections, tally);
    match_boxes(image, object, truths, detections, tally);
  }

  void match_poses(const BopImage& image, int id, const EvaluatedObject& object,
                   const std::vector<const BopGt*>& truths, const std::vector<const BopResult*>& detections,
                   Tally& tally) {
    std::vector<const BopResult*> matched(truths.size(), nullptr);
    std::vector<std::size_t> taken_by;  // per detection that counts: its truth, or none
    std::vector<double> scores;
    for (const BopResult* detection : detections) {
      const Eigen::Vector3d centre = detection->camera_from_mesh * object.centre_m;
      std::size_t nearest = truths.size();
      double distance = 0;
      for (std::size_t i = 0; i < truths.size(); ++i) {
        if (matched[i]) continue;
        const double d = (truths[i]->camera_from_mesh * object.centre_m - centre).norm();
        if (nearest == truths.size() || d < distance) {
          nearest = i;
          distance = d;
        }
      }
      const bool taken = nearest < truths.size();
      if (taken) matched[nearest] = detection;
      if (!taken) {
        report_.false_answers.push_back(
            {image.scene_id, image.image_id, id, detection->score, detection->camera_from_mesh});
      }
      if (taken && ignored(image, *truths[nearest], object, options_)) continue;
      ++tally.report.detections;
      taken_by.push_back(nearest);
      scores.push_back(detection->score);
    }
    std::vector<bool> right(truths.size(), false);
    for (std::size_t i = 0; i < truths.size(); ++i) {
      if (ignored(image, *truths[i], object, options_)) continue;
      InstanceResult instance = compare(image, id, object, *truths[i], matched[i]);
      instance.scene_id = image.scene_id;
      instance.image_id = image.image_id;
      instance.object_id = id;
      right[i] = instance.right;
      count(instance, object, tally);
      report_.instances.push_back(instance);
    }
    for (std::size_t i = 0; i < scores.size(); ++i)
      tally.answers.push_back({scores[i], taken_by[i] < truths.size() && right[taken_by[i]]});
  }

  InstanceResult compare(const BopImage& image, int id, const EvaluatedObject& object, const BopGt& truth,
                         const BopResult* detection) const {
    InstanceResult r;
    r.truth = truth.camera_from_mesh;
    r.visible = truth.visible_fraction.value_or(1);
    if (!detection) return r;
    const RigidTransform& estimate = detection->camera_from_mesh;
    r.found = true;
    r.estimate = estimate;
    r.score = detection->score;
    r.translation_cm = 100 * (estimate * object.centre_m - truth.camera_from_mesh * object.centre_m).norm();
    r.rotation_deg =
        kRadian * rotation_error_rad(estimate.linear(), truth.camera_from_mesh.linear(), object.symmetry);
    r.right = r.translation_cm <= options_.max_translation_cm && r.rotation_deg <= options_.max_rotation_deg;
    r.strict =
        r.translation_cm <= options_.strict_translation_cm && r.rotation_deg <= options_.strict_rotation_deg;
    if (const auto turn = turntable_error_rad(estimate.linear(), truth.camera_from_mesh.linear(),
                                              object.symmetry, object.up)) {
      r.turntable_deg = kRadian * *turn;
    }
    if (!object.points.empty()) {
      const std::vector<RigidTransform>& symmetries = symmetries_.at(id);
      r.mssd_mm = 1000 * mssd_m(object.points, estimate, truth.camera_from_mesh, symmetries);
      r.mspd_px = mspd_px(object.points, image.camera, estimate, truth.camera_from_mesh, symmetries);
      r.add_mm = 1000 * add_m(object.points, estimate, truth.camera_from_mesh);
      r.add_s_mm = 1000 * add_s_m(object.points, estimate, truth.camera_from_mesh);
    }
    return r;
  }

  void count(const InstanceResult& r, const EvaluatedObject& object, Tally& tally) const {
    ++tally.report.instances;
    if (!r.found) return;
    ++tally.report.found;
    tally.report.right += r.right ? 1 : 0;
    tally.report.strict += r.strict ? 1 : 0;
    tally.translations.push_back(r.translation_cm);
    tally.rotations.push_back(r.rotation_deg);
    tally.within_translation += r.translation_cm <= options_.max_translation_cm ? 1 : 0;
    tally.within_rotation += r.rotation_deg <= options_.max_rotation_deg ? 1 : 0;
    if (!tally.has_add) return;
    const bool symmetric = object.symmetry.rotations.size() > 1 || !object.symmetry.axes.empty();
    const double error_mm = symmetric ? *r.add_s_mm : *r.add_mm;
    tally.within_add += error_mm < 1000 * kAddShare * object.diameter_m ? 1 : 0;
  }

  /// PASCAL's rule: the best overlap decides; a second hit on the same object is a miss.
  void match_boxes(const BopImage& image, const EvaluatedObject& object,
                   const std::vector<const BopGt*>& truths, const std::vector<const BopResult*>& detections,
                   Tally& tally) const {
    std::vector<std::optional<cv::Rect2d>> boxes;
    boxes.reserve(truths.size());
    for (const BopGt* gt : truths) boxes.push_back(box_of(object, image.camera, gt->camera_from_mesh));
    std::vector<bool> used(truths.size(), false);
    for (const BopResult* detection : detections) {
      const auto box = box_of(object, image.camera, detection->camera_from_mesh);
      std::size_t best = truths.size();
      double best_overlap = 0.5;
      for (std::size_t i = 0; i < truths.size(); ++i) {
        const double o = overlap(box, boxes[i]);
        if (o > best_overlap) {
          best = i;
          best_overlap = o;
        }
      }
      const bool on_object = best < truths.size();
      if (on_object && ignored(image, *truths[best], object, options_)) continue;
      tally.boxes.push_back({detection->score, on_object && !used[best]});
      if (on_object) used[best] = true;
    }
  }

  /// Rows and columns of the confusion matrices that this image contributes to.
  void add_confusion(const BopImage& image, const std::vector<BopResult>& results) {
    std::map<int, std::vector<cv::Rect2d>> true_boxes;
    for (const BopGt& gt : image.ground_truth) {
      const auto object = objects_.find(gt.object_id);
      if (object == objects_.end() || ignored(image, gt, object->second, options_)) continue;
      if (const auto box = box_of(object->second, image.camera, gt.camera_from_mesh))
        true_boxes[gt.object_id].push_back(*box);
    }
    struct Seen {
      int predicted;
      cv::Point2d centre;
      bool on_own;
    };
    std::vector<Seen> seen;
    for (const BopResult& result : results) {
      const auto object = objects_.find(result.object_id);
      if (object == objects_.end()) continue;
      const auto box = box_of(object->second, image.camera, result.camera_from_mesh);
      if (!box) continue;
      bool on_own = false;
      for (const cv::Rect2d& own : true_boxes[result.object_id]) on_own = on_own || overlap(box, own) > 0.5;
      seen.push_back({result.object_id, {box->x + box->width / 2, box->y + box->height / 2}, on_own});
    }
    for (const auto& [actual, boxes] : true_boxes) {
      if (boxes.empty()) continue;
      ++report_.confusion.images[actual];
      std::set<int> anywhere;
      std::set<int> inside;
      for (const Seen& s : seen) {
        if ((s.predicted == actual) != s.on_own) continue;
        anywhere.insert(s.predicted);
        for (const cv::Rect2d& box : boxes) {
          if (box.contains(s.centre)) inside.insert(s.predicted);
        }
      }
      for (const int predicted : anywhere) ++report_.confusion.anywhere[actual][predicted];
      for (const int predicted : inside) ++report_.confusion.inside[actual][predicted];
    }
  }

  /// BOP's recalls of one object, or of all (id -1).
  void add_recalls(ObjectReport& report, int id) const {
    std::vector<const InstanceResult*> instances;
    bool known = report.instances > 0;
    for (const InstanceResult& r : report_.instances) {
      if (id >= 0 && r.object_id != id) continue;
      instances.push_back(&r);
      const EvaluatedObject& object = objects_.at(r.object_id);
      known = known && !object.points.empty() && object.diameter_m > 0;
    }
    if (!known) return;
    report.ar_mssd = recall_mssd(instances, objects_);
    report.ar_mspd = recall_mspd(instances, options_.image_width);
  }

  static void add_up(Tally& total, const Tally& part) {
    total.report.instances += part.report.instances;
    total.report.found += part.report.found;
    total.report.right += part.report.right;
    total.report.detections += part.report.detections;
    total.report.false_images += part.report.false_images;
    total.report.false_detections += part.report.false_detections;
    total.translations.insert(total.translations.end(), part.translations.begin(), part.translations.end());
    total.rotations.insert(total.rotations.end(), part.rotations.begin(), part.rotations.end());
    total.boxes.insert(total.boxes.end(), part.boxes.begin(), part.boxes.end());
    total.answers.insert(total.answers.end(), part.answers.begin(), part.answers.end());
    total.report.strict += part.report.strict;
    total.within_translation += part.within_translation;
    total.within_rotation += part.within_rotation;
    total.within_add += part.within_add;
  }

  static ObjectReport closed(const Tally& tally, bool has_boxes) {
    ObjectReport report = tally.report;
    const double n = std::max(1, report.instances);
    report.median_translation_cm = median(tally.translations);
    report.median_rotation_deg = median(tally.rotations);
    report.share_translation = tally.within_translation / n;
    report.share_rotation = tally.within_rotation / n;
    if (tally.has_add) report.add_recall = tally.within_add / n;
    if (has_boxes) {
      report.average_precision = average_precision(tally.boxes, report.instances);
      report.curve = precision_recall_curve(tally.boxes, report.instances);
    }
    report.calibrated = calibration(tally.answers);
    return report;
  }

  const std::map<int, EvaluatedObject>& objects_;
  const EvaluationOptions& options_;
  std::map<int, Tally> tallies_;
  std::map<int, std::vector<RigidTransform>> symmetries_;
  EvaluationReport report_;
};

template <typename Below>
double mean_recall(const std::vector<const InstanceResult*>& instances, const Below& below) {
  double sum = 0;
  for (const InstanceResult* r : instances) {
    for (int i = 0; i < kBopThresholds && r->found; ++i) sum += below(*r, i);
  }
  return instances.empty() ? 0 : sum / (static_cast<double>(instances.size()) * kBopThresholds);
}

}  // namespace

double recall_mssd(const std::vector<const InstanceResult*>& instances,
                   const std::map<int, EvaluatedObject>& objects) {
  return mean_recall(instances, [&](const InstanceResult& r, int i) {
    return r.mssd_mm && *r.mssd_mm < 1000 * bop_share(i) * objects.at(r.object_id).diameter_m ? 1.0 : 0.0;
  });
}

double recall_mspd(const std::vector<const InstanceResult*>& instances, int image_width) {
  return mean_recall(instances, [&](const InstanceResult& r, int i) {
    return r.mspd_px && *r.mspd_px < bop_pixels(i, image_width) ? 1.0 : 0.0;
  });
}

double recall_vsd(const std::vector<const InstanceResult*>& instances) {
  return mean_recall(instances, [&](const InstanceResult& r, int limit) {
    double below = 0;
    for (const double error : r.vsd) below += error < bop_share(limit) ? 1 : 0;
    return r.vsd.empty() ? 0 : below / static_cast<double>(r.vsd.size());
  });
}

EvaluationReport evaluate(const std::vector<BopImage>& images, const std::vector<BopResult>& results,
                          const std::map<int, EvaluatedObject>& objects, const EvaluationOptions& options,
                          const std::string& results_file) {
  std::map<ImageKey, std::vector<BopResult>> by_image;
  for (const BopImage& image : images) by_image[{image.scene_id, image.image_id}];
  for (const BopResult& result : results) {
    const auto it = by_image.find({result.scene_id, result.image_id});
    if (it == by_image.end()) {
      throw InputError(results_file,
                       fmt::format("names scene {} image {}, which is not in the data set", result.scene_id,
                                   result.image_id),
                       "evaluate them against the data set they were made from");
    }
    it->second.push_back(result);
  }
  Evaluator evaluator(objects, options);
  std::vector<double> seconds;
  for (const BopImage& image : images) {
    const std::vector<BopResult>& rows = by_image[{image.scene_id, image.image_id}];
    evaluator.add(image, rows);
    if (!rows.empty() && rows[0].seconds >= 0) {
      seconds.push_back(rows[0].seconds);
    }
  }
  EvaluationReport report = evaluator.finish();
  if (!seconds.empty()) {
    report.mean_seconds =
        std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(seconds.size());
  }
  report.seconds = std::move(seconds);
  return report;
}

}  // namespace sextant
