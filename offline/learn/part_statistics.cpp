// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/part_statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "offline/learn/parameters.h"
#include "runtime/tables/distance_transform.h"

namespace sextant {
namespace {

constexpr int kClipPx = 24;
// What a sensor adds at least, before anything was measured: edges 0.8 px at 1 m, depth 3 mm.
constexpr double kEdgeNoise = 0.8 / kReferenceFocal;
constexpr double kDepthNoise = 0.003;
// Priors, in numbers of scenes: shares learnt from a few dozen scenes must not reach 0 or 1.
constexpr double kPriorScenes = 3;
constexpr double kLeastShare = 0.02;

/// Variance of a normal distribution cut at kFoundSigmas, in units of the whole one's: per axis of two, and
/// of one.
constexpr double kCutVariance2 = 0.856;
constexpr double kCutVariance1 = 0.911;

/// Sums of one part.
struct Tally {
  std::array<int, 3> seen{};   ///< looked at, per SceneTruth
  std::array<int, 3> found{};  ///< of them found
};

double share(int found, int seen, double prior) {
  return std::clamp((found + kPriorScenes * prior) / (seen + kPriorScenes), kLeastShare, 1 - kLeastShare);
}

PartStatistics statistics_of(const Tally& t, double spread, double found_prior, double background_prior) {
  const auto at = [](SceneTruth truth) { return static_cast<std::size_t>(truth); };
  const auto background = [&](SceneTruth truth) {
    return share(t.found[at(truth)], t.seen[at(truth)], background_prior);
  };
  PartStatistics s;
  s.spread = static_cast<float>(spread);
  s.found = static_cast<float>(
      share(t.found[at(SceneTruth::kObject)], t.seen[at(SceneTruth::kObject)], found_prior));
  const double clutter = background(SceneTruth::kClutter);
  const bool turned = t.seen[at(SceneTruth::kTurnedObject)] > 0;
  s.background =
      static_cast<float>(turned ? 0.5 * (clutter + background(SceneTruth::kTurnedObject)) : clutter);
  return s;
}

float linear(const std::array<float, 4>& c, const Pose6& p) {
  return static_cast<float>(c[0] + c[1] * p.rx + c[2] * p.ry + c[3] * p.rz);
}

/// Index of the window's pixel at an offset (tangent * metre) from the object's centre; empty outside.
std::optional<std::size_t> pixel_at(const SceneView& view, double scale, double u, double v) {
  const int x = static_cast<int>(std::floor(view.hypothesis.x + scale * u + 0.5)) - view.window.x;
  const int y = static_cast<int>(std::floor(view.hypothesis.y + scale * v + 0.5)) - view.window.y;
  if (x < 0 || y < 0 || x >= view.window.width || y >= view.window.height) return std::nullopt;
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.window.width) +
         static_cast<std::size_t>(x);
}

/// Squared differences of every part in one scene; empty where it cannot be seen.
using Look = std::vector<float>;
constexpr float kUnseen = -1;

Look look_at(const SceneView& view, double focal, const std::vector<VisualPart>& parts) {
  const double scale = focal / view.hypothesis.z;
  const std::size_t size =
      static_cast<std::size_t>(view.window.width) * static_cast<std::size_t>(view.window.height);
  std::array<std::vector<std::uint16_t>, kFeatureKinds> distance;
  for (std::size_t kind = 0; kind < distance.size(); ++kind) {
    distance[kind].resize(size);
    clipped_distance2(view.edges, static_cast<int>(kind), kClipPx, distance[kind].data(), view.window.width);
  }
  Look look(parts.size(), kUnseen);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto at =
        pixel_at(view, scale, linear(parts[i].u, view.hypothesis), linear(parts[i].v, view.hypothesis));
    if (!at) continue;
    const std::uint16_t d2 = distance[parts[i].kind][*at];
    look[i] = d2 == 65535 ? std::numeric_limits<float>::infinity() : static_cast<float>(d2 / (scale * scale));
  }
  return look;
}

Look look_at(const SceneView& view, double focal, const std::vector<DepthPart>& parts) {
  const double scale = focal / view.hypothesis.z;
  Look look(parts.size(), kUnseen);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto at = pixel_at(view, scale, parts[i].px, parts[i].py);
    if (!at) continue;
    const float depth = view.ray_depth_m.ptr<float>()[*at];
    if (!(depth > 0)) continue;
    const double difference = depth - (view.hypothesis.z + linear(parts[i].d, view.hypothesis));
    look[i] = static_cast<float>(difference * difference);
  }
  return look;
}

/// What is known before measuring.
struct Prior {
  double spread, found, background;
};
Prior prior_of(const VisualPart& p) {
  return {p.variance / 2.0 + kEdgeNoise * kEdgeNoise, p.seen.found, p.seen.background};
}
Prior prior_of(const DepthPart& p) {
  return {p.variance + kDepthNoise * kDepthNoise, p.seen.found, p.seen.background};
}

// By chance, depth is where it is: what scenes of clutter say about one spot is their own small number. What
// they say about edges of one direction at one spot of a view tells a lot.
constexpr bool background_is_measured(const VisualPart&) { return true; }
constexpr bool background_is_measured(const DepthPart&) { return false; }

template <typename Part>
void measure(const std::vector<TestScene>& scenes, double focal, std::vector<Part>& parts, int dimensions,
             double cut_variance) {
  if (scenes.empty()) return;
  std::vector<Look> looks;
  looks.reserve(scenes.size());
  for (const TestScene& scene : scenes) looks.push_back(look_at(scene.view, focal, parts));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Prior prior = prior_of(parts[i]);
    const double first_gate = kFoundSigmas * kFoundSigmas * prior.spread;
    double square = 0;
    double count = 0;
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      if (scenes[k].truth != SceneTruth::kObject || looks[k][i] == kUnseen || looks[k][i] > first_gate)
        continue;
      square += static_cast<double>(looks[k][i]) / dimensions / cut_variance;
      count += 1;
    }
    const double spread = (square + kPriorScenes * prior.spread) / (count + kPriorScenes);
    const double gate = kFoundSigmas * kFoundSigmas * spread;
    Tally tally;
    for (std::size_t k = 0; k < scenes.size(); ++k) {
      if (looks[k][i] == kUnseen) continue;
      const auto truth = static_cast<std::size_t>(scenes[k].truth);
      ++tally.seen[truth];
      tally.found[truth] += looks[k][i] <= gate;
    }
    const PartStatistics before = parts[i].seen;
    parts[i].seen = statistics_of(tally, spread, prior.found, prior.background);
    parts[i].seen.weight = before.weight;
    if (!background_is_measured(parts[i])) parts[i].seen.background = before.background;
  }
}

}  // namespace

void measure_parts(const std::vector<TestScene>& scenes, const PinholeCamera& camera,
                   std::vector<VisualPart>& parts) {
  measure(scenes, camera.focal, parts, 2, kCutVariance2);
}

void measure_parts(const std::vector<TestScene>& scenes, const PinholeCamera& camera,
                   std::vector<DepthPart>& parts) {
  measure(scenes, camera.focal, parts, 1, kCutVariance1);
}

}  // namespace sextant
