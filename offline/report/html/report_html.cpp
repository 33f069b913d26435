// SPDX-License-Identifier: Apache-2.0
#include "offline/report/html/report_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "offline/report/html/html_page.h"
#include "offline/report/html/worst_cases.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kWorstListed = 40;

std::string percent(double share) { return fmt::format("{:.1f}&thinsp;%", 100 * share); }
std::string optional_percent(const std::optional<double>& v) { return v ? percent(*v) : "&ndash;"; }
std::string optional_number(const std::optional<double>& v, int digits = 3) {
  return v ? fmt::format("{:.{}f}", *v, digits) : "&ndash;";
}

std::string card(const std::string& value, const std::string& what) {
  return fmt::format("<div class=card><b>{}</b><span>{}</span></div>\n", value, what);
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

std::string cards(const EvaluationReport& report) {
  const ObjectReport& all = report.total;
  const EvaluationOptions& o = report.options;
  std::string html = "<div class=cards>\n";
  html += card(percent(all.share_right()),
               fmt::format("within {:g} cm and {:g}&deg;", o.max_translation_cm, o.max_rotation_deg));
  html += card(percent(all.share_strict()),
               fmt::format("within {:g} cm and {:g}&deg;", o.strict_translation_cm, o.strict_rotation_deg));
  html += card(optional_number(all.average_precision), "average precision, IoU &gt; 0.5");
  html += card(optional_number(all.average_recall()), "BOP average recall");
  html += card(fmt::format("{:.1f} mm", 10 * all.median_translation_cm), "median position error");
  if (all.calibrated)
    html += card(fmt::format("{:.3f}", all.calibrated->expected_error), "calibration error");
  if (!report.seconds.empty())
    html += card(fmt::format("{:.0f} ms", 1000 * quantile(report.seconds, 0.5)), "median time per image");
  return html + "</div>\n";
}

std::string row_of(const ObjectReport& o, bool all) {
  return fmt::format(
      "<tr{}><th>{}</th><td>{}</td><td>{}</td><td class=bar>{}<i style='width:{:.1f}%'></i></td><td>{}</td>"
      "<td>{:.1f}</td><td>{:.1f}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
      "<td>{}</td><td>{} / {}</td></tr>\n",
      all ? " class=all" : "", escaped_html(o.name), o.instances, o.found, percent(o.share_right()),
      100 * o.share_right(), percent(o.share_strict()), 10 * o.median_translation_cm, o.median_rotation_deg,
      percent(o.precision()), optional_number(o.average_precision), optional_percent(o.add_recall),
      optional_number(o.ar_vsd), optional_number(o.ar_mssd), optional_number(o.ar_mspd),
      optional_number(o.average_recall()), o.false_detections, o.false_images);
}

std::string object_table(const EvaluationReport& report) {
  std::string html =
      "<h2>Objects</h2>\n<div class=scroll><table><thead><tr><th></th><th>instances</th><th>found</th>"
      "<th>right</th><th>strictly right</th><th>median mm</th><th>median &deg;</th><th>precision</th>"
      "<th>AP50</th><th>ADD(-S) &lt; 10&thinsp;%</th><th>VSD</th><th>MSSD</th><th>MSPD</th><th>AR</th>"
      "<th>detections / images without it</th></tr></thead><tbody>\n";
  for (const auto& [id, object] : report.objects) html += row_of(object, false);
  if (report.objects.size() != 1) html += row_of(report.total, true);
  return html +
         "</tbody></table></div>\n<p>VSD, MSSD, MSPD: mean recall over the BOP challenge's thresholds; AR is "
         "their mean. Shares are of all instances, medians of those found.</p>\n";
}

std::string worst_section(const EvaluationReport& report, const std::vector<CasePicture>& worst) {
  const std::vector<const InstanceResult*> wrong = worst_instances(report);
  std::string html = fmt::format("<h2>Not right: {} of {}</h2>\n", wrong.size(), report.instances.size());
  if (!worst.empty()) {
    html +=
        "<p class=legend>Outlines: <b class=truth>truth</b>, <b class=answer>answer</b>. Worst first; false "
        "alarms last.</p>\n<div class=cases>\n";
    for (const CasePicture& picture : worst) {
      html += fmt::format(
          "<figure><img alt='{0}' src='data:image/jpeg;base64,{1}'><figcaption>{0}</figcaption></figure>\n",
          escaped_html(picture.caption), base64(picture.jpeg));
    }
    html += "</div>\n";
  }
  return html;
}

std::string worst_list(const EvaluationReport& report) {
  const std::vector<const InstanceResult*> wrong = worst_instances(report);
  if (wrong.empty()) return "";
  std::string html =
      "<h2>List of what is not right</h2>\n<div class=scroll><table><thead><tr><th>scene</th><th>image</th>"
      "<th>object</th><th>visible</th><th>score</th><th>cm</th><th>&deg;</th><th>turntable &deg;</th>"
      "<th>ADD mm</th><th>MSSD mm</th></tr></thead><tbody>\n";
  for (std::size_t i = 0; i < std::min(kWorstListed, wrong.size()); ++i) {
    const InstanceResult& r = *wrong[i];
    html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", r.scene_id, r.image_id,
                        r.object_id, percent(r.visible));
    if (r.found) {
      html +=
          fmt::format("<td>{:.3g}</td><td>{:.2f}</td><td>{:.1f}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                      r.score, r.translation_cm, r.rotation_deg, optional_number(r.turntable_deg, 1),
                      optional_number(r.add_mm, 1), optional_number(r.mssd_mm, 1));
    } else {
      html += "<td colspan=6 class=bad>not found</td></tr>\n";
    }
  }
  html += "</tbody></table></div>\n";
  if (wrong.size() > kWorstListed) html += fmt::format("<p>and {} more</p>\n", wrong.size() - kWorstListed);
  return html;
}

std::string matrix_of(const EvaluationReport& report, const std::map<int, std::map<int, int>>& rows,
                      const std::string& caption, const std::string& note) {
  std::string html = fmt::format(
      "<figure class=matrix><figcaption>{}<small>{}</small></figcaption><table><tr><th></th>", caption, note);
  for (const auto& [id, object] : report.objects) html += fmt::format("<th>{}</th>", id);
  html += "</tr>\n";
  for (const auto& [actual, images] : report.confusion.images) {
    html += fmt::format("<tr><th>{}</th>", actual);
    for (const auto& [predicted, object] : report.objects) {
      const auto row = rows.find(actual);
      int count = 0;
      if (row != rows.end()) {
        const auto cell = row->second.find(predicted);
        if (cell != row->second.end()) count = cell->second;
      }
      const double share = static_cast<double>(count) / images;
      // Blue where it should be high, orange where it should be low.
      const std::string tint = predicted == actual ? "0,114,178" : "213,94,0";
      html += fmt::format("<td style='background:rgba({},{:.2f});color:{}'>{}</td>", tint, share,
                          share > 0.55 ? "#fff" : "inherit",
                          count > 0 ? fmt::format("{:.2f}", share) : "&middot;");
    }
    html += "</tr>\n";
  }
  return html + "</table></figure>\n";
}

/// Charts by name, in the order of the page.
class Charts {
 public:
  void add(const std::string& name, const std::string& caption, const std::string& note, Json chart) {
    charts_[name] = std::move(chart);
    html_ += fmt::format(
        "<figure><figcaption>{}<small>{}</small></figcaption><div class=plot>"
        "<canvas data-chart={} role=img aria-label=\"{}\"></canvas></div></figure>\n",
        caption, note, name, caption);
  }
  const std::string& html() const { return html_; }
  Json data() const { return {{"charts", charts_}}; }

 private:
  Json charts_ = Json::object();
  std::string html_;
};

void add_precision_recall(Charts& charts, const EvaluationReport& report) {
  Json series = Json::array();
  for (const auto& [id, object] : report.objects) {
    if (object.curve.empty()) continue;
    Json points = Json::array({Json::array({0.0, object.curve.front().precision})});
    for (const PrecisionRecall& p : object.curve) points.push_back({p.recall, p.precision});
    series.push_back({{"name", object.name}, {"points", points}});
  }
  if (series.empty()) return;
  charts.add("precision", "Precision and recall",
             "2D boxes with IoU &gt; 0.5, images with and without the object",
             {{"type", "line"},
              {"x", {{"title", "recall"}, {"min", 0}, {"max", 1}}},
              {"y", {{"title", "precision"}, {"min", 0}, {"max", 1.02}}},
              {"series", series}});
}

/// Share of all instances whose error is at most x.
Json cumulative(const std::vector<double>& errors, std::size_t all, double limit) {
  std::vector<double> sorted = errors;
  std::sort(sorted.begin(), sorted.end());
  Json points = Json::array({Json::array({0.0, 0.0})});
  for (std::size_t i = 0; i < sorted.size() && sorted[i] <= limit; ++i)
    points.push_back({sorted[i], static_cast<double>(i + 1) / static_cast<double>(all)});
  points.push_back({limit, points.back()[1]});
  return points;
}

void add_cumulative(Charts& charts, const EvaluationReport& report, double InstanceResult::*error,
                    double limit, const std::string& name, const std::string& caption,
                    const std::string& unit) {
  Json series = Json::array();
  for (const auto& [id, object] : report.objects) {
    std::vector<double> errors;
    for (const InstanceResult& r : report.instances) {
      if (r.object_id == id && r.found) errors.push_back(r.*error);
    }
    if (object.instances == 0) continue;
    series.push_back({{"name", object.name},
                      {"stepped", true},
                      {"points", cumulative(errors, static_cast<std::size_t>(object.instances), 3 * limit)}});
  }
  charts.add(name, caption, fmt::format("share of all instances within; the limit is {:g} {}", limit, unit),
             {{"type", "line"},
              {"x", {{"title", unit}, {"min", 0}, {"max", 3 * limit}}},
              {"y", {{"title", "share"}, {"min", 0}, {"max", 1}}},
              {"series", series}});
}

/// Counts of values in equal steps; what lies beyond goes into the last one.
Json histogram(const std::vector<double>& values, double low, double high, int steps) {
  std::vector<int> counts(static_cast<std::size_t>(steps), 0);
  for (const double v : values) {
    const double at = std::clamp((v - low) / (high - low) * steps, 0.0, steps - 0.5);
    ++counts[static_cast<std::size_t>(at)];
  }
  return counts;
}

void add_histogram(Charts& charts, const std::string& name, const std::string& caption,
                   const std::string& note, const std::string& unit, const std::vector<double>& values,
                   double low, double high, int steps, const std::string& counted = "instances") {
  if (values.empty()) return;
  Json labels = Json::array();
  for (int i = 0; i < steps; ++i) {
    const double from = low + (high - low) * i / steps;
    labels.push_back(fmt::format("{:.3g}{}", from, i + 1 == steps ? "+" : ""));
  }
  charts.add(name, caption, note,
             {{"type", "bar"},
              {"labels", labels},
              {"x", {{"title", unit}}},
              {"y", {{"title", counted}, {"min", 0}, {"whole", true}}},
              {"series", {{{"name", caption}, {"values", histogram(values, low, high, steps)}}}}});
}

void add_visibility(Charts& charts, const EvaluationReport& report) {
  constexpr int kSteps = 5;
  std::vector<int> all(kSteps, 0);
  std::vector<int> right(kSteps, 0);
  for (const InstanceResult& r : report.instances) {
    const auto step = static_cast<std::size_t>(std::clamp(r.visible * kSteps, 0.0, kSteps - 0.01));
    ++all[step];
    right[step] += r.right ? 1 : 0;
  }
  Json labels = Json::array();
  Json values = Json::array();
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (all[i] == 0) continue;
    labels.push_back(fmt::format("{}-{} % ({})", i * 20, i * 20 + 20, all[i]));
    values.push_back(static_cast<double>(right[i]) / all[i]);
  }
  if (labels.size() < 2) return;
  charts.add("visibility", "Right, by visibility",
             "share of the instances that are that visible (their number)",
             {{"type", "bar"},
              {"labels", labels},
              {"x", {{"title", "visible"}}},
              {"y", {{"title", "share right"}, {"min", 0}, {"max", 1}}},
              {"series", {{{"name", "right"}, {"values", values}}}}});
}

void add_calibration(Charts& charts, const EvaluationReport& report) {
  if (!report.total.calibrated) return;
  const Calibration& c = *report.total.calibrated;
  Json points = Json::array();
  for (const CalibrationBin& bin : c.bins) {
    if (bin.count > 0) points.push_back({bin.mean_confidence, bin.share_right});
  }
  charts.add("calibration", "Reliability",
             fmt::format("calibration error {:.3f}; {} answers above 0.95{}", c.expected_error, c.sure,
                         c.sure > 0 ? ", " + percent(c.share_sure_right) + " of them right" : ""),
             {{"type", "line"},
              {"x", {{"title", "stated confidence"}, {"min", 0}, {"max", 1}}},
              {"y", {{"title", "share right"}, {"min", 0}, {"max", 1}}},
              {"series",
               {{{"name", "answers"}, {"points", points}, {"dots", true}},
                {{"name", "ideal"}, {"points", {{0, 0}, {1, 1}}}, {"dashed", true}, {"grey", true}}}}});
}

}  // namespace

std::string format_report_html(const EvaluationReport& report, const std::string& title,
                               const std::vector<CasePicture>& worst) {
  Charts charts;
  const EvaluationOptions& o = report.options;
  if (!report.instances.empty()) {
    add_precision_recall(charts, report);
    add_cumulative(charts, report, &InstanceResult::translation_cm, o.max_translation_cm, "position",
                   "Position error", "cm");
    add_cumulative(charts, report, &InstanceResult::rotation_deg, o.max_rotation_deg, "rotation",
                   "Rotation error", "deg");
    std::vector<double> distances;
    std::vector<double> turns;
    for (const InstanceResult& r : report.instances) {
      if (r.found) distances.push_back(10 * r.translation_cm);
      if (r.turntable_deg) turns.push_back(*r.turntable_deg);
    }
    add_histogram(charts, "distances", "Position errors",
                  "distance of the object's centre; all beyond in the last bar", "mm", distances, 0,
                  30 * o.max_translation_cm, 30);
    add_histogram(charts, "turns", "Turntable errors",
                  "about the object's up, of objects for which it is defined", "deg", turns, -180, 180, 36);
    add_visibility(charts, report);
    add_calibration(charts, report);
  }
  if (!report.seconds.empty()) {
    std::vector<double> ms;
    for (const double s : report.seconds) ms.push_back(1000 * s);
    const double top = std::max(1.0, 1.25 * quantile(ms, 0.98));
    add_histogram(
        charts, "times", "Time per image",
        fmt::format("median {:.0f} ms, 95 % within {:.0f} ms", quantile(ms, 0.5), quantile(ms, 0.95)), "ms",
        ms, 0, top, 25, "images");
  }
  std::string body =
      fmt::format("<h1>{}</h1>\n<p>{} images, {} instances. Errors are modulo the objects' symmetries.</p>\n",
                  escaped_html(title), report.images, report.instances.size());
  body += cards(report) + worst_section(report, worst) + object_table(report);
  if (!charts.html().empty()) body += "<h2>Charts</h2>\n<div class=charts>\n" + charts.html() + "</div>\n";
  if (report.objects.size() > 1 && !report.confusion.images.empty()) {
    body +=
        "<h2>Confusion</h2>\n<p>Rows: the object that is in the image. Columns: the detector that answers. "
        "Share of "
        "the images with the row's object.</p>\n<div class=charts>\n";
    body += matrix_of(report, report.confusion.anywhere, "Anywhere in the image",
                      "off the diagonal: detections on no object of their kind");
    body += matrix_of(report, report.confusion.inside, "Within the true box",
                      "of them, those whose centre lies in the row's object's box");
    body += "</div>\n";
  }
  body += worst_list(report);
  return html_page(title, body, charts.data().dump());
}

}  // namespace sextant
