// SPDX-License-Identifier: Apache-2.0
// The page is plain HTML with inline style and SVG: it opens anywhere and can be sent by mail.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "offline/evaluate/report_text.h"

namespace sextant {
namespace {

constexpr std::size_t kWorstShown = 40;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '&':
        out += "&amp;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string percent(double share) { return fmt::format("{:.1f}&thinsp;%", 100 * share); }

std::string row_of(const ObjectReport& o) {
  return fmt::format(
      "<tr><th>{}</th><td>{}</td><td>{}</td><td class=key><i "
      "style='width:{:.1f}%'></i>{}</td><td>{}</td><td>{}</td>"
      "<td>{:.2f}</td><td>{:.1f}</td><td>{}</td><td>{}</td><td>{}</td><td>{} / {}</td></tr>\n",
      escaped(o.name), o.instances, o.found, 100 * o.share_right(), percent(o.share_right()),
      percent(o.share_translation), percent(o.share_rotation), o.median_translation_cm, o.median_rotation_deg,
      percent(o.precision()), o.average_precision ? fmt::format("{:.3f}", *o.average_precision) : "&ndash;",
      o.add_recall ? percent(*o.add_recall) : "&ndash;", o.false_detections, o.false_images);
}

/// Share of all instances whose error is at most x, as a stepped line.
std::string curve(const std::vector<InstanceResult>& instances, double InstanceResult::*error, double limit,
                  const std::string& label, const std::string& unit) {
  constexpr double kWidth = 360;
  constexpr double kHeight = 170;
  const double right_edge = 4 * limit;
  std::vector<double> errors;
  for (const InstanceResult& r : instances) {
    if (r.found) errors.push_back(r.*error);
  }
  std::sort(errors.begin(), errors.end());
  std::string path = fmt::format("M0 {}", kHeight);
  for (std::size_t i = 0; i < errors.size() && errors[i] <= right_edge; ++i) {
    path += fmt::format("H{:.1f}V{:.1f}", errors[i] / right_edge * kWidth,
                        kHeight * (1 - static_cast<double>(i + 1) / static_cast<double>(instances.size())));
  }
  path += fmt::format("H{}", kWidth);
  std::string grid;
  for (int i = 0; i <= 4; ++i) {
    const double x = kWidth * i / 4;
    const double y = kHeight * i / 4;
    grid += fmt::format(
        "<line x1='{0}' y1='0' x2='{0}' y2='{1}' class='{2}'/><line x1='0' y1='{3}' x2='{4}' y2='{3}' "
        "class=grid />"
        "<text x='{0}' y='{5}' text-anchor=middle>{6:g}</text><text x='-6' y='{7}' "
        "text-anchor=end>{8}</text>",
        x, kHeight, i == 1 ? "limit" : "grid", y, kWidth, kHeight + 16, limit * i, y + 4, 100 - 25 * i);
  }
  return fmt::format(
      "<figure><figcaption>{} [{}]: share of instances [%] within</figcaption>"
      "<svg viewBox='-40 -10 420 205'>{}<path d='{}'/></svg></figure>\n",
      label, unit, grid, path);
}

std::string instance_row(const InstanceResult& r) {
  const auto mm = [](const std::optional<double>& v) {
    return v ? fmt::format("{:.1f}", *v) : std::string("&ndash;");
  };
  if (!r.found) {
    return fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td colspan=5 class=bad>not found</td></tr>\n",
                       r.scene_id, r.image_id, r.object_id);
  }
  return fmt::format(
      "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.3g}</td><td>{:.2f}</td><td>{:.1f}</td><td>{}</td><td>{}</"
      "td></tr>\n",
      r.scene_id, r.image_id, r.object_id, r.score, r.translation_cm, r.rotation_deg, mm(r.add_mm),
      mm(r.add_s_mm));
}

constexpr const char* kStyle = R"(<style>
body{font:15px/1.45 system-ui,sans-serif;max-width:1080px;margin:2em auto;padding:0 1em;color:#1c2530;background:#fff}
h1{font-size:1.5em}h2{font-size:1.1em;margin-top:2em}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th,td{padding:.35em .6em;text-align:right;border-bottom:1px solid #dde3ea}tr>:first-child{text-align:left}
thead th{font-weight:600;color:#53606e;vertical-align:bottom}
td.key{position:relative;font-weight:600}td.key i{position:absolute;left:0;top:15%;bottom:15%;background:#bfe3f2;z-index:-1}
td.bad{color:#b3261e;text-align:left}figure{display:inline-block;width:48%;min-width:320px;margin:0}
figcaption{color:#53606e}svg text{font-size:11px;fill:#53606e}.grid{stroke:#e3e8ee}.limit{stroke:#e08a00;stroke-dasharray:4 3}
svg path{fill:none;stroke:#0077a8;stroke-width:2}
</style>)";

}  // namespace

std::string format_report_html(const EvaluationReport& report, const std::string& title) {
  std::string html =
      "<!doctype html><html lang=en><meta charset=utf-8><title>" + escaped(title) + "</title>\n" + kStyle;
  html += fmt::format(
      "<h1>{}</h1>\n<p>{} images{}. A pose is right within {:g} cm and {:g}&deg; of the truth, modulo "
      "the object's symmetry.</p>\n",
      escaped(title), report.images,
      report.mean_seconds ? fmt::format(", {:.3f} s each", *report.mean_seconds) : "",
      report.options.max_translation_cm, report.options.max_rotation_deg);
  html +=
      "<table><thead><tr><th></th><th>instances</th><th>found</th><th>right</th><th>translation right</th>"
      "<th>rotation right</th><th>median cm</th><th>median "
      "&deg;</th><th>precision</th><th>AP50</th><th>ADD</th>"
      "<th>detections / images without it</th></tr></thead><tbody>\n";
  for (const auto& [id, object] : report.objects) html += row_of(object);
  if (report.objects.size() != 1) html += row_of(report.total);
  html += "</tbody></table>\n<h2>Errors</h2>\n";
  if (!report.instances.empty()) {
    html += curve(report.instances, &InstanceResult::translation_cm, report.options.max_translation_cm,
                  "Translation", "cm");
    html += curve(report.instances, &InstanceResult::rotation_deg, report.options.max_rotation_deg,
                  "Rotation", "&deg;");
  }
  std::vector<InstanceResult> worst;
  for (const InstanceResult& r : report.instances) {
    if (!r.right) worst.push_back(r);
  }
  const auto badness = [&](const InstanceResult& r) {
    return r.found ? std::max(r.translation_cm / report.options.max_translation_cm,
                              r.rotation_deg / report.options.max_rotation_deg)
                   : HUGE_VAL;
  };
  std::stable_sort(worst.begin(), worst.end(),
                   [&](const InstanceResult& a, const InstanceResult& b) { return badness(a) > badness(b); });
  html += fmt::format("<h2>Not right: {} of {}</h2>\n", worst.size(), report.instances.size());
  if (!worst.empty()) {
    html +=
        "<table><thead><tr><th>scene</th><th>image</th><th>object</th><th>score</th><th>cm</th><th>&deg;</th>"
        "<th>ADD mm</th><th>ADD-S mm</th></tr></thead><tbody>\n";
    for (std::size_t i = 0; i < std::min(kWorstShown, worst.size()); ++i) html += instance_row(worst[i]);
    html += "</tbody></table>\n";
  }
  return html + "</html>\n";
}

}  // namespace sextant
