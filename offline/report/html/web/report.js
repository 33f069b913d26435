// SPDX-License-Identifier: Apache-2.0
// Draws the charts of a report from the JSON in the page: every <canvas data-chart="name"> gets the chart of
// that name from data.charts. A chart: {type: "line" | "bar" | "scatter", x: {title, min, max}, y: {...},
// series: [{name, points: [[x, y], ..], dashed, area}], labels: [..], band: [from, to]}.
"use strict";
(function () {
  const root = document.documentElement;
  window.addEventListener("error", (event) => {
    if (!root.dataset.error) root.dataset.error = String(event.message);
  });
  // Okabe-Ito: told apart by readers with any colour vision.
  const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6b4fa0", "#7f7f7f", "#1b2430"];
  const data = JSON.parse(document.getElementById("data").textContent);
  Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
  Chart.defaults.color = "#5b6877";
  Chart.defaults.animation = false;
  Chart.defaults.maintainAspectRatio = false;

  function axis(spec, isCategory) {
    const scale = { title: { display: Boolean(spec.title), text: spec.title }, grid: { color: "#e9eef3" } };
    if (!isCategory) scale.type = spec.log ? "logarithmic" : "linear";
    if (spec.min !== undefined) scale.min = spec.min;
    if (spec.max !== undefined) scale.max = spec.max;
    if (spec.whole) scale.ticks = { precision: 0 };
    return scale;
  }

  function dataset(series, index, chart) {
    const colour = series.grey ? "#9aa5b1" : colours[index % colours.length];
    const set = {
      label: series.name,
      data: chart.labels ? series.values : series.points.map(([x, y]) => ({ x, y })),
      borderColor: colour,
      backgroundColor: chart.type === "bar" ? colour + "cc" : colour + "22",
      borderWidth: chart.type === "bar" ? 0 : 2,
      fill: Boolean(series.area),
    };
    if (chart.type === "line") {
      set.pointRadius = series.dots ? 3.5 : 0;
      set.pointHitRadius = 8;
      set.tension = 0;
      if (series.stepped) set.stepped = "after";
      if (series.dashed) set.borderDash = [5, 4];
    }
    if (chart.type === "scatter") set.pointRadius = 3;
    return set;
  }

  let drawn = 0;
  for (const canvas of document.querySelectorAll("canvas[data-chart]")) {
    const chart = data.charts[canvas.dataset.chart];
    const categories = Boolean(chart.labels);
    new Chart(canvas, {
      type: chart.type,
      data: { labels: chart.labels, datasets: chart.series.map((s, i) => dataset(s, i, chart)) },
      options: {
        scales: { x: axis(chart.x, categories), y: axis(chart.y, false) },
        plugins: {
          legend: { display: chart.series.length > 1, position: "bottom", labels: { boxWidth: 14, boxHeight: 3 } },
          tooltip: { mode: categories ? "index" : "nearest", intersect: false },
        },
        interaction: { mode: categories ? "index" : "nearest", intersect: false },
        datasets: { bar: { categoryPercentage: 0.92, barPercentage: 0.95 } },
      },
    });
    drawn += 1;
  }
  root.dataset.charts = String(drawn);
})();
