// SPDX-License-Identifier: Apache-2.0
#include "offline/tune/tune_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "offline/report/html/html_page.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const TrialScore& s) {
  return {{"images", s.images},
          {"instances", s.instances},
          {"average_precision", s.average_precision},
          {"share_right", s.share_right},
          {"share_strict", s.share_strict},
          {"seconds", s.seconds}};
}

std::string row(const std::string& name, const TrialScore& s, const char* mark) {
  return fmt::format("{:<44} {:>6.3f} {:>7.1f} % {:>7.1f} % {:>9.3f} {}\n", name, s.average_precision,
                     100 * s.share_right, 100 * s.share_strict, s.seconds, mark);
}

std::string html_row(const std::string& name, const TrialScore& s, bool bold) {
  return fmt::format(
      "<tr{}><th>{}</th><td>{:.3f}</td><td>{:.1f}&thinsp;%</td><td>{:.1f}&thinsp;%</td><td>{:.3f}</td></"
      "tr>\n",
      bold ? " class=all" : "", escaped_html(name), s.average_precision, 100 * s.share_right,
      100 * s.share_strict, s.seconds);
}

/// Metric over the values of one parameter, all others at their defaults.
Json chart_of(const TuneRun& run, const TuneResult& result, const Sweep& sweep) {
  Json labels = Json::array({"default"});
  Json values = Json::array({metric_of(result.training[0], run.metric)});
  Json seconds = Json::array({result.training[0].seconds});
  for (const std::string& value : sweep.values) {
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      if (result.points[i] != TunePoint{{sweep.name, value}}) continue;
      labels.push_back(value);
      values.push_back(metric_of(result.training[i], run.metric));
      seconds.push_back(result.training[i].seconds);
    }
  }
  return {{"type", "bar"},
          {"labels", labels},
          {"x", {{"title", sweep.name}}},
          {"y", {{"title", "metric / seconds"}, {"min", 0}}},
          {"series",
           {{{"name", run.metric + ", training half"}, {"values", values}},
            {{"name", "seconds per image"}, {"values", seconds}}}}};
}

}  // namespace

std::string format_tune_text(const TuneRun& run, const TuneResult& result) {
  std::string text =
      fmt::format("{:<44} {:>6} {:>9} {:>9} {:>9}\n", "training half", "AP", "right", "strict", "s/image");
  for (std::size_t i = 0; i < result.points.size(); ++i)
    text += row(describe(result.points[i]), result.training[i], i == result.best ? "<- best" : "");
  text += fmt::format("\nheld-out half ({} images, {} instances; never looked at in choosing, by {})\n",
                      result.held_out_best.images, result.held_out_best.instances, run.metric);
  text += row("defaults", result.held_out_defaults, "");
  if (result.best != 0) text += row(describe(result.points[result.best]), result.held_out_best, "");
  return text;
}

std::string format_tune_json(const TuneRun& run, const TuneResult& result) {
  Json json;
  json["metric"] = run.metric;
  json["points"] = Json::array();
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    Json point = to_json(result.training[i]);
    point["parameters"] = result.points[i];
    json["points"].push_back(point);
  }
  json["best"] = result.best;
  json["parameters"] = result.points[result.best];
  json["held_out"] = {{"defaults", to_json(result.held_out_defaults)},
                      {"best", to_json(result.held_out_best)}};
  return json.dump();
}

std::string format_tune_html(const TuneRun& run, const TuneResult& result, const std::string& title) {
  const char* head =
      "<thead><tr><th></th><th>AP50</th><th>right</th><th>strict</th><th>s per image</th></tr></thead>";
  std::string body = fmt::format(
      "<h1>{}</h1>\n<p>Chosen by {} on the training half ({} images, {} instances); the "
      "held-out half ({} images) was not looked at in choosing.</p>\n",
      escaped_html(title), run.metric, result.training[0].images, result.training[0].instances,
      result.held_out_best.images);
  body += fmt::format("<h2>Held-out half</h2>\n<div class=scroll><table>{}<tbody>\n", head);
  body += html_row("defaults", result.held_out_defaults, false);
  body += html_row(describe(result.points[result.best]), result.held_out_best, true);
  body += "</tbody></table></div>\n";
  Json charts = Json::object();
  if (!run.grid) {
    body += "<h2>One parameter at a time</h2>\n<div class=charts>\n";
    for (const Sweep& sweep : run.sweeps) {
      charts[sweep.name] = chart_of(run, result, sweep);
      body += fmt::format(
          "<figure><figcaption>{0}<small>the others at their defaults</small></figcaption><div class=plot>"
          "<canvas data-chart=\"{0}\"></canvas></div></figure>\n",
          escaped_html(sweep.name));
    }
    body += "</div>\n";
  }
  body += fmt::format("<h2>Training half</h2>\n<div class=scroll><table>{}<tbody>\n", head);
  for (std::size_t i = 0; i < result.points.size(); ++i)
    body += html_row(describe(result.points[i]), result.training[i], i == result.best);
  body += "</tbody></table></div>\n";
  return html_page(title, body, Json{{"charts", charts}}.dump());
}

std::string format_tuned_yaml(const TuneResult& result, const TuneParameters& base) {
  const TunePoint& best = result.points[result.best];
  const TuneParameters tuned = apply(base, best);
  std::string text =
      "# " + describe(best) +
      fmt::format(": held-out AP {:.3f}, right {:.1f} %\n", result.held_out_best.average_precision,
                  100 * result.held_out_best.share_right);
  std::string options = fmt::format(" --angle-tolerance-deg {:g}", tuned.learn.angle_tolerance_deg);
  if (best.count("height_tolerance_m") > 0)
    options += fmt::format(" --height-tolerance-m {:g}", tuned.detect.tolerance.height_m);
  if (best.count("scoring") > 0) options += " --scoring " + tuned.detect.scoring;
  if (best.count("threshold") > 0) options += fmt::format(" --threshold {:g}", *tuned.detect.threshold);
  if (best.count("search_width") > 0) options += fmt::format(" --search-width {}", tuned.detect.search_width);
  text += "# sextant detect MODEL" + options + "\n";
  // {a: 1, b: 2} -> one per line.
  const std::string flow = tuned.learn.to_yaml();
  for (std::size_t from = 1; from + 1 < flow.size();) {
    std::size_t end = flow.find(", ", from);
    if (end == std::string::npos) end = flow.size() - 1;
    text += flow.substr(from, end - from) + "\n";
    from = end + 2;
  }
  return text;
}

}  // namespace sextant
