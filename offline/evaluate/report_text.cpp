// SPDX-License-Identifier: Apache-2.0
#include "offline/evaluate/report_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }
std::string percent(const std::optional<double>& share) { return share ? percent(*share) : "-"; }
std::string number(const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

std::string line_of(const ObjectReport& o) {
  const std::string false_share = fmt::format("{}/{}", o.false_detections, o.false_images);
  const auto of_found = [&](double value, int digits) {
    return o.found > 0 ? fmt::format("{:.{}f}", value, digits) : "-";
  };
  const auto of_all = [&](double share) { return o.instances > 0 ? percent(share) : "-"; };
  return fmt::format(
      "{:<14} {:>9} {:>6} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8} {:>9} {:>6} {:>8} {:>6} {:>9}\n", o.name,
      o.instances, o.found, of_all(o.share_right()), of_all(o.share_strict()), of_all(o.share_translation),
      of_all(o.share_rotation), of_found(o.median_translation_cm, 2), of_found(o.median_rotation_deg, 1),
      o.detections > 0 ? percent(o.precision()) : "-", o.instances > 0 ? number(o.average_precision) : "-",
      o.instances > 0 ? percent(o.add_recall) : "-", number(o.average_recall()), false_share);
}

Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json by_id(const std::map<int, int>& counts) {
  Json json = Json::object();
  for (const auto& [id, count] : counts) json[std::to_string(id)] = count;
  return json;
}

Json matrix(const std::map<int, std::map<int, int>>& rows) {
  Json json = Json::object();
  for (const auto& [actual, row] : rows) json[std::to_string(actual)] = by_id(row);
  return json;
}

Json to_json(const ObjectReport& o) {
  return {{"instances", o.instances},
          {"found", o.found},
          {"right", o.right},
          {"detections", o.detections},
          {"share_right", o.share_right()},
          {"share_translation", o.share_translation},
          {"share_rotation", o.share_rotation},
          {"median_translation_cm", o.median_translation_cm},
          {"median_rotation_deg", o.median_rotation_deg},
          {"precision", o.precision()},
          {"recall", o.recall()},
          {"average_precision", optional_number(o.average_precision)},
          {"add_recall", optional_number(o.add_recall)},
          {"false_images", o.false_images},
          {"false_detections", o.false_detections},
          {"share_strict", o.share_strict()},
          {"ar_mssd", optional_number(o.ar_mssd)},
          {"ar_mspd", optional_number(o.ar_mspd)},
          {"ar_vsd", optional_number(o.ar_vsd)},
          {"average_recall", optional_number(o.average_recall())},
          {"calibration_error", o.calibrated ? Json(o.calibrated->expected_error) : Json(nullptr)},
          {"sure", o.calibrated ? Json(o.calibrated->sure) : Json(nullptr)},
          {"share_sure_right",
           o.calibrated && o.calibrated->sure > 0 ? Json(o.calibrated->share_sure_right) : Json(nullptr)}};
}

}  // namespace

std::string format_report_text(const EvaluationReport& report) {
  const std::string cm = fmt::format("<{:g} cm", report.options.max_translation_cm);
  const std::string deg = fmt::format("<{:g} deg", report.options.max_rotation_deg);
  std::string text =
      fmt::format("{:<14} {:>9} {:>6} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8} {:>9} {:>6} {:>8} {:>6} {:>9}\n",
                  "", "instances", "found", "both", "strict", cm, deg, "med cm", "med deg", "precision",
                  "AP50", "ADD", "AR", "false/img");
  for (const auto& [id, object] : report.objects) text += line_of(object);
  if (report.objects.size() != 1) text += line_of(report.total);
  text += fmt::format("{} images", report.images);
  if (report.mean_seconds) text += fmt::format(", {:.3f} s each", *report.mean_seconds);
  text += fmt::format("; both: {} and {}; strict: <{:g} cm and <{:g} deg; AR: BOP's mean of VSD, MSSD, MSPD",
                      cm, deg, report.options.strict_translation_cm, report.options.strict_rotation_deg);
  if (report.total.calibrated) {
    const Calibration& c = *report.total.calibrated;
    text += fmt::format("\ncalibration error {:.3f}; {} answers above 0.95", c.expected_error, c.sure);
    if (c.sure > 0) text += fmt::format(", {} of them right", percent(c.share_sure_right));
  }
  return text + "\n";
}

std::string format_report_json(const EvaluationReport& report) {
  Json json;
  json["images"] = report.images;
  json["seconds"] = optional_number(report.mean_seconds);
  json["total"] = to_json(report.total);
  json["objects"] = Json::object();
  for (const auto& [id, object] : report.objects) json["objects"][std::to_string(id)] = to_json(object);
  json["instances"] = Json::array();
  for (const InstanceResult& r : report.instances) {
    json["instances"].push_back({{"scene_id", r.scene_id},
                                 {"im_id", r.image_id},
                                 {"obj_id", r.object_id},
                                 {"found", r.found},
                                 {"right", r.right},
                                 {"strict", r.strict},
                                 {"score", r.score},
                                 {"translation_cm", r.found ? Json(r.translation_cm) : Json(nullptr)},
                                 {"rotation_deg", r.found ? Json(r.rotation_deg) : Json(nullptr)},
                                 {"add_mm", optional_number(r.add_mm)},
                                 {"add_s_mm", optional_number(r.add_s_mm)},
                                 {"mssd_mm", optional_number(r.mssd_mm)},
                                 {"mspd_px", optional_number(r.mspd_px)},
                                 {"turntable_deg", optional_number(r.turntable_deg)},
                                 {"visible", r.visible}});
  }
  json["confusion"] = {{"images", by_id(report.confusion.images)},
                       {"anywhere", matrix(report.confusion.anywhere)},
                       {"inside", matrix(report.confusion.inside)}};
  return json.dump();
}

}  // namespace sextant
