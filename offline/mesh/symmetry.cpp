// SPDX-License-Identifier: Apache-2.0
#include "offline/mesh/symmetry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <span>

#include "offline/mesh/surface_index.h"

namespace sextant {
namespace {

constexpr std::size_t kSamples = 5000;
constexpr double kFar = 0.05;        // of the bounding radius: no point may be off by this
constexpr double kNear = 0.02;       // of the bounding radius
constexpr double kFewPoints = 0.01;  // share of points that may be off by more than kNear
constexpr float kColourStep = 0.15F;
constexpr double kFewColours = 0.02;  // share of points that may differ in colour

class Comparison {
 public:
  Comparison(const Mesh& mesh, double radius)
      : mesh_(mesh), list_(triangle_list(mesh)), index_(list_.vertices, list_.triangles), radius_(radius) {
    samples_ = spread_points(list_.vertices, list_.triangles, kSamples);
    for (const SurfacePoint& sample : samples_) colours_.push_back(colour_at(sample));
  }

  struct Result {
    bool shape = false;
    bool print = false;
  };

  Result same_after(double turn_deg) const {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const auto few = static_cast<std::size_t>(kFewPoints * static_cast<double>(samples_.size()));
    std::size_t off = 0;
    std::size_t other_colour = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Eigen::Vector3d turned = turn * samples_[i].position;
      const SurfacePoint seen = index_.closest(turned);
      const double distance = (seen.position - turned).norm();
      if (distance > kNear * radius_ && ++off > few) return {};
      if (distance > kFar * radius_) return {};
      if ((colour_at(seen) - colours_[i]).cwiseAbs().maxCoeff() > kColourStep) ++other_colour;
    }
    const auto few_colours = static_cast<std::size_t>(kFewColours * static_cast<double>(samples_.size()));
    return {true, other_colour <= few_colours};
  }

 private:
  Eigen::Vector3f colour_at(const SurfacePoint& point) const {
    return surface_colour(mesh_, mesh_.parts[list_.part[point.triangle]], list_.triangles[point.triangle],
                          point.barycentric);
  }

  const Mesh& mesh_;
  TriangleList list_;
  SurfaceIndex index_;
  double radius_;
  std::vector<SurfacePoint> samples_;
  std::vector<Eigen::Vector3f> colours_;
};

}  // namespace

Eigen::Vector3f surface_colour(const Mesh& mesh, const MeshPart& part,
                               const std::array<std::uint32_t, 3>& triangle, const Eigen::Vector3d& weights) {
  const Eigen::Vector3f w = weights.cast<float>();
  Eigen::Vector3f colour =
      w[0] * mesh.colours[triangle[0]] + w[1] * mesh.colours[triangle[1]] + w[2] * mesh.colours[triangle[2]];
  colour = colour.cwiseProduct(part.diffuse);
  if (part.texture < 0) return colour;
  const cv::Mat& image = mesh.textures[static_cast<std::size_t>(part.texture)];
  const Eigen::Vector2f uv =
      w[0] * mesh.uvs[triangle[0]] + w[1] * mesh.uvs[triangle[1]] + w[2] * mesh.uvs[triangle[2]];
  const auto wrapped = [](float t) { return t - std::floor(t); };
  const float x = wrapped(uv.x()) * static_cast<float>(image.cols) - 0.5F;
  const float y = wrapped(1 - uv.y()) * static_cast<float>(image.rows) - 0.5F;
  const float fx = x - std::floor(x);
  const float fy = y - std::floor(y);
  const auto texel = [&](float column, float row) {
    const int c = (static_cast<int>(column) + image.cols) % image.cols;
    const int r = (static_cast<int>(row) + image.rows) % image.rows;
    const cv::Vec3b& t = image.at<cv::Vec3b>(r, c);
    return Eigen::Vector3f(Eigen::Vector3f(t[0], t[1], t[2]) / 255);
  };
  const float c0 = std::floor(x);
  const float r0 = std::floor(y);
  const Eigen::Vector3f above = (1 - fx) * texel(c0, r0) + fx * texel(c0 + 1, r0);
  const Eigen::Vector3f below = (1 - fx) * texel(c0, r0 + 1) + fx * texel(c0 + 1, r0 + 1);
  return colour.cwiseProduct((1 - fy) * above + fy * below);
}

TurnSymmetry detect_turn_symmetry(const Mesh& mesh, double bounding_radius_m) {
  const Comparison comparison(mesh, bounding_radius_m);
  const auto same_after_all = [&](std::span<const double> turns) {
    Comparison::Result all{true, true};
    for (const double turn : turns) {
      const Comparison::Result one = comparison.same_after(turn);
      all.shape = all.shape && one.shape;
      all.print = all.print && one.shape && one.print;
      if (!all.shape) break;
    }
    return all;
  };
  // Turns of no common divisor: what is the same after all of them is the same after any.
  constexpr double kAnyTurn[] = {7, 17, 31, 45, 61, 83, 107, 131, 163, 180};
  constexpr double kQuarter[] = {90};
  constexpr double kHalf[] = {180};
  struct Level {
    int degrees;
    std::span<const double> turns;
  };
  TurnSymmetry found;
  bool shape_known = false;
  for (const Level& level : {Level{0, kAnyTurn}, Level{90, kQuarter}, Level{180, kHalf}}) {
    const Comparison::Result same = same_after_all(level.turns);
    if (same.shape && !shape_known) {
      found.of_shape_deg = level.degrees;
      shape_known = true;
    }
    if (same.print) {
      found.with_print_deg = level.degrees;
      break;
    }
  }
  return found;
}

}  // namespace sextant
