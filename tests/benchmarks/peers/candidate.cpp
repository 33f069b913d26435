// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/peers/candidate.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/icp.hpp>

namespace sextant {
namespace {

/// Points and normals of a depth image (axial metres) by finite differences; rows only where both exist.
cv::Mat oriented_points(const cv::Mat& depth, const PinholeCamera& camera, int step_px,
                        const std::function<bool(const Eigen::Vector3d&)>& wanted) {
  cv::Mat points(0, 6, CV_32FC1);
  const auto at = [&](int x, int y) {
    const double z = depth.at<float>(y, x);
    return Eigen::Vector3d((x - camera.cx) / camera.focal * z, (y - camera.cy) / camera.focal * z, z);
  };
  constexpr int kReach = 3;
  for (int y = kReach; y < depth.rows - kReach; y += step_px) {
    for (int x = kReach; x < depth.cols - kReach; x += step_px) {
      if (depth.at<float>(y, x) <= 0) continue;
      const Eigen::Vector3d p = at(x, y);
      if (!wanted(p)) continue;
      if (depth.at<float>(y, x - kReach) <= 0 || depth.at<float>(y, x + kReach) <= 0 ||
          depth.at<float>(y - kReach, x) <= 0 || depth.at<float>(y + kReach, x) <= 0) {
        continue;
      }
      const Eigen::Vector3d across = at(x + kReach, y) - at(x - kReach, y);
      const Eigen::Vector3d down = at(x, y + kReach) - at(x, y - kReach);
      if (std::max(across.norm(), down.norm()) > 0.04) continue;  // over an edge
      Eigen::Vector3d n = across.cross(down).normalized();
      if (n.dot(p) > 0) n = -n;
      const cv::Mat row = (cv::Mat_<float>(1, 6) << p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
      points.push_back(row);
    }
  }
  return points;
}

cv::Mat axial(const cv::Mat& ray_depth, const PinholeCamera& camera) {
  cv::Mat depth(ray_depth.size(), CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x)
      depth.at<float>(y, x) = static_cast<float>(ray_depth.at<float>(y, x) * camera.ray(x, y).z());
  }
  return depth;
}

cv::Mat moved(const cv::Mat& points, const RigidTransform& transform) {
  cv::Mat result(points.size(), CV_32FC1);
  for (int i = 0; i < points.rows; ++i) {
    const float* r = points.ptr<float>(i);
    const Eigen::Vector3d p = transform * Eigen::Vector3d(r[0], r[1], r[2]);
    const Eigen::Vector3d n = transform.linear() * Eigen::Vector3d(r[3], r[4], r[5]);
    for (int k = 0; k < 3; ++k) {
      result.at<float>(i, k) = static_cast<float>(p[k]);
      result.at<float>(i, 3 + k) = static_cast<float>(n[k]);
    }
  }
  return result;
}

}  // namespace

cv::Mat points_above_table(const RgbdFrame& frame, const PinholeCamera& camera, double low_m, double high_m,
                           int step_px) {
  const TableGeometry& table = *frame.table;
  return oriented_points(frame.axial_depth_m, camera, step_px, [&](const Eigen::Vector3d& p) {
    const double height = table.up_in_camera.dot(p) + table.camera_height_m;
    return height > low_m && height < high_m && p.norm() < 2.0;
  });
}

cv::Mat visible_points(Renderer& renderer, const PeerObject& object, const PinholeCamera& camera,
                       const RigidTransform& camera_from_object, int step_px) {
  const RenderedView view = renderer.render_geometry(camera, {0, 0, camera.width, camera.height},
                                                     {{object.mesh, camera_from_object}});
  const cv::Mat points = oriented_points(axial(view.ray_depth_m, camera), camera, step_px,
                                         [](const Eigen::Vector3d&) { return true; });
  return moved(points, camera_from_object.inverse());
}

RigidTransform refined(Renderer& renderer, const PeerObject& object, const PinholeCamera& camera,
                       const cv::Mat& scene_points, const RigidTransform& camera_from_object,
                       double reach_m) {
  const cv::Mat model =
      moved(visible_points(renderer, object, camera, camera_from_object, 4), camera_from_object);
  cv::Mat near(0, 6, CV_32FC1);
  const Eigen::Vector3d centre = camera_from_object.translation();
  for (int i = 0; i < scene_points.rows; ++i) {
    const float* r = scene_points.ptr<float>(i);
    if ((Eigen::Vector3d(r[0], r[1], r[2]) - centre).norm() < object.object.bounding_radius_m + reach_m)
      near.push_back(scene_points.row(i));
  }
  if (model.rows < 60 || near.rows < 60) return camera_from_object;
  cv::ppf_match_3d::ICP icp(60, 0.005F, 2.5F, 4);
  double residual = 0;
  cv::Matx44d step = cv::Matx44d::eye();
  if (icp.registerModelToScene(model, near, residual, step) != 0) return camera_from_object;
  RigidTransform delta = RigidTransform::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) delta.matrix()(r, c) = step(r, c);
  }
  const RigidTransform result = delta * camera_from_object;
  const bool sane = result.matrix().allFinite() && std::abs(delta.linear().determinant() - 1) < 1e-3 &&
                    (result.translation() - centre).norm() < 0.05;
  return sane ? result : camera_from_object;
}

RigidTransform stood_on_table(const RigidTransform& camera_from_object, const TableGeometry& table,
                              double centre_height_m) {
  RigidTransform result = camera_from_object;
  const Eigen::Vector3d up = camera_from_object.linear().col(2);
  result.linear() = Eigen::Quaterniond::FromTwoVectors(up, table.up_in_camera).toRotationMatrix() *
                    camera_from_object.linear();
  const double height = table.up_in_camera.dot(result.translation()) + table.camera_height_m;
  result.translation() += (centre_height_m - height) * table.up_in_camera;
  return result;
}

Agreement agreement(Renderer& renderer, const PeerObject& object, const RgbdFrame& frame,
                    const PinholeCamera& camera, const RigidTransform& camera_from_object) {
  Light light;
  light.ambient = 0.8;
  const RenderedView view = renderer.render(camera, {0, 0, camera.width, camera.height},
                                            {{object.mesh, camera_from_object}}, light, {0, 0, 0});
  const cv::Mat depth = axial(view.ray_depth_m, camera);
  int all = 0;
  int known = 0;
  int close = 0;
  // Correlation of the three channels, each about its own mean.
  std::array<double, 3> sa{}, sb{}, saa{}, sbb{}, sab{};
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float expected = depth.at<float>(y, x);
      if (expected <= 0) continue;
      ++all;
      const float measured = frame.axial_depth_m.at<float>(y, x);
      if (measured > 0) {
        ++known;
        close += std::abs(measured - expected) < 0.01F ? 1 : 0;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const double a = view.colour.at<cv::Vec3b>(y, x)[static_cast<int>(c)];
        const double b = frame.colour.at<cv::Vec3b>(y, x)[static_cast<int>(c)];
        sa[c] += a;
        sb[c] += b;
        saa[c] += a * a;
        sbb[c] += b * b;
        sab[c] += a * b;
      }
    }
  }
  Agreement result;
  if (all == 0) return result;
  result.known = static_cast<double>(known) / all;
  result.depth = known > 0 ? static_cast<double>(close) / known : 0;
  double covariance = 0;
  double va = 0;
  double vb = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    covariance += sab[c] - sa[c] * sb[c] / all;
    va += saa[c] - sa[c] * sa[c] / all;
    vb += sbb[c] - sb[c] * sb[c] / all;
  }
  result.colour = va > 1 && vb > 1 ? covariance / std::sqrt(va * vb) : 0;
  return result;
}

}  // namespace sextant
