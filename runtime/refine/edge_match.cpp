// SPDX-License-Identifier: Apache-2.0
#include "runtime/refine/edge_match.h"

#include <cmath>
#include <numbers>

#include "runtime/model/object_model.h"

namespace sextant {
namespace {

/// The kind whose direction is nearest to the line perpendicular to the normal.
unsigned kind_bit(const Eigen::Vector2d& normal) {
  const double line = std::atan2(normal.x(), -normal.y());
  const int kind = static_cast<int>(std::lround(line / std::numbers::pi * kFeatureKinds));
  return 1U << static_cast<unsigned>((kind + 2 * kFeatureKinds) % kFeatureKinds);
}

/// Place along the normal of an edge pixel at or beside the point `s` steps out, or empty.
std::optional<double> edge_at(const cv::Mat& edges, const Eigen::Vector2d& pixel,
                              const Eigen::Vector2d& normal, double s, unsigned bit) {
  const Eigen::Vector2d p = pixel + s * normal;
  const int x = static_cast<int>(std::lround(p.x()));
  const int y = static_cast<int>(std::lround(p.y()));
  if (x < 0 || y < 0 || x >= edges.cols || y >= edges.rows) return std::nullopt;
  if ((edges.ptr<unsigned char>(y)[x] & bit) == 0) return std::nullopt;
  return (Eigen::Vector2d(x, y) - pixel).dot(normal);
}

}  // namespace

std::optional<double> nearest_edge(const cv::Mat& edges, const Eigen::Vector2d& pixel,
                                   const Eigen::Vector2d& normal, double reach) {
  const unsigned bit = kind_bit(normal);
  if (const auto here = edge_at(edges, pixel, normal, 0, bit)) return here;
  for (double s = 1; s <= reach; s += 1) {
    const auto ahead = edge_at(edges, pixel, normal, s, bit);
    const auto behind = edge_at(edges, pixel, normal, -s, bit);
    if (ahead && behind) return std::nullopt;
    if (ahead) return ahead;
    if (behind) return behind;
  }
  return std::nullopt;
}

}  // namespace sextant
