// SPDX-License-Identifier: Apache-2.0
// OpenCV contrib's LINEMOD (Hinterstoisser et al., ICCV 2011) with the same table knowledge as ours: a
// template counts only where the table puts the object at the template's distance and elevation. A colour and
// depth check by rendering and ICP follow, as in Hinterstoisser et al., ACCV 2012.
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/linemod.hpp>

#include "runtime/geometry/pose_mapping.h"
#include "tests/benchmarks/peers/candidate.h"

namespace sextant {
namespace {

constexpr int kTurnStepDeg = 12;
constexpr double kElevationStepDeg = 8;
constexpr double kDistanceRatio = 1.12;
constexpr float kThreshold = 62;  ///< per cent of the features
constexpr std::size_t kVerified = 20;

struct Template {
  double distance = 0, elevation = 0, turn = 0;  ///< metres, radians
  cv::Point2d centre_in_box;                     ///< of the object, from the template's upper left corner
};

cv::Mat depth_in_mm(const cv::Mat& axial_m) {
  cv::Mat mm;
  axial_m.convertTo(mm, CV_16UC1, 1000);
  return mm;
}

cv::Mat bgr(const cv::Mat& rgb) {
  cv::Mat result;
  cv::cvtColor(rgb, result, cv::COLOR_RGB2BGR);
  return result;
}

class LinemodPeer : public Peer {
 public:
  LinemodPeer() : detector_(cv::linemod::getDefaultLINEMOD()) {}

  void learn(const PeerObject& object, const PinholeCamera& camera, const PeerRanges& ranges,
             Renderer& renderer) override {
    const std::string name = std::to_string(object.id);
    const int turn_end = object.object.symmetry_deg == 0 ? kTurnStepDeg : object.object.symmetry_deg;
    for (double distance = ranges.min_distance_m; distance < ranges.max_distance_m * kDistanceRatio;
         distance *= kDistanceRatio) {
      // The elevation differs from the camera's pitch by up to half the field of view.
      for (double e = ranges.min_pitch_deg - 20; e <= ranges.max_pitch_deg + 24; e += kElevationStepDeg) {
        for (int turn = 0; turn < turn_end; turn += kTurnStepDeg)
          add(object, camera, renderer, name, distance, e, turn);
      }
    }
  }

  std::optional<PeerAnswer> find(const PeerObject& object, const RgbdFrame& frame,
                                 const PinholeCamera& camera, Renderer& renderer) override {
    const std::string name = std::to_string(object.id);
    std::vector<cv::linemod::Match> matches;
    detector_->match({bgr(frame.colour), depth_in_mm(frame.axial_depth_m)}, kThreshold, matches, {name});
    std::vector<Candidate> candidates = standing(object, frame, camera, matches);
    const cv::Mat scene =
        points_above_table(frame, camera, 0.006, 2 * object.object.centre_height_m + 0.03, 3);
    std::optional<PeerAnswer> best;
    for (const Candidate& candidate : candidates) {
      RigidTransform pose = refined(renderer, object, camera, scene, candidate.pose, 0.03);
      pose = stood_on_table(pose, *frame.table, object.object.centre_height_m);
      const Agreement a = agreement(renderer, object, frame, camera, pose);
      const double score = candidate.similarity / 100 + a.depth * std::min(1.0, a.known / 0.5) + a.colour;
      if (!best || score > best->score) best = PeerAnswer{pose, score};
    }
    return best;
  }

 private:
  struct Candidate {
    RigidTransform pose;
    double similarity;
    cv::Point2d pixel;
  };

  void add(const PeerObject& object, const PinholeCamera& camera, Renderer& renderer, const std::string& name,
           double distance, double elevation_deg, int turn_deg) {
    Pose6 pose;
    pose.x = camera.cx;
    pose.y = camera.cy;
    pose.z = distance;
    pose.ry = -elevation_deg * M_PI / 180;
    pose.rz = turn_deg * M_PI / 180;
    const RigidTransform transform = transform_from_pose(camera, pose);
    Light light;
    light.position_in_camera = {0.3, -0.6, 0};
    light.ambient = 0.6;
    // The part of the picture around the object, with room for the pyramid's filters.
    const int reach = static_cast<int>(1.3 * camera.focal * object.object.bounding_radius_m / distance) + 24;
    const cv::Rect window(static_cast<int>(camera.cx) - reach, static_cast<int>(camera.cy) - reach, 2 * reach,
                          2 * reach);
    const RenderedView view =
        renderer.render(camera, window, {{object.mesh, transform}}, light, {128, 128, 128});
    const cv::Mat mask = view.item == 0;
    cv::Mat depth(view.ray_depth_m.size(), CV_32FC1);
    for (int y = 0; y < depth.rows; ++y) {
      for (int x = 0; x < depth.cols; ++x)
        depth.at<float>(y, x) =
            static_cast<float>(view.ray_depth_m.at<float>(y, x) * camera.ray(x + window.x, y + window.y).z());
    }
    cv::Rect box;
    const int id = detector_->addTemplate({bgr(view.colour), depth_in_mm(depth)}, name, mask, &box);
    if (id < 0) return;
    std::vector<Template>& known = templates_[name];
    known.resize(std::max<std::size_t>(known.size(), static_cast<std::size_t>(id) + 1));
    known[static_cast<std::size_t>(id)] = {distance, elevation_deg * M_PI / 180, pose.rz,
                                           cv::Point2d(pose.x - window.x - box.x, pose.y - window.y - box.y)};
  }

  /// Matches that the table allows, best first, one per place and turntable angle.
  std::vector<Candidate> standing(const PeerObject& object, const RgbdFrame& frame,
                                  const PinholeCamera& camera,
                                  const std::vector<cv::linemod::Match>& matches) const {
    std::vector<Candidate> result;
    const std::vector<Template>& known = templates_.at(std::to_string(object.id));
    const TableGeometry& table = *frame.table;
    for (const cv::linemod::Match& match : matches) {  // sorted by similarity
      const Template& t = known[static_cast<std::size_t>(match.template_id)];
      Pose6 pose;
      pose.x = match.x + t.centre_in_box.x;
      pose.y = match.y + t.centre_in_box.y;
      const UprightPose upright = upright_pose_at(camera, table.up_in_camera, pose.x, pose.y);
      if (upright.sine_of_elevation <= 0.05) continue;
      pose.z = (table.camera_height_m - object.object.centre_height_m) / upright.sine_of_elevation;
      const double ratio = pose.z / t.distance;
      if (ratio > 1.1 || ratio < 1 / 1.1 || std::abs(-upright.ry - t.elevation) > 8 * M_PI / 180) continue;
      pose.rx = upright.rx;
      pose.ry = upright.ry;
      pose.rz = t.turn;
      const RigidTransform transform = transform_from_pose(camera, pose);
      const bool again = std::any_of(result.begin(), result.end(), [&](const Candidate& c) {
        return std::hypot(c.pixel.x - pose.x, c.pixel.y - pose.y) < 10 &&
               c.pose.linear().col(0).dot(transform.linear().col(0)) > std::cos(15 * M_PI / 180);
      });
      if (again) continue;
      result.push_back({transform, match.similarity, {pose.x, pose.y}});
      if (result.size() == kVerified) break;
    }
    return result;
  }

  cv::Ptr<cv::linemod::Detector> detector_;
  std::map<std::string, std::vector<Template>> templates_;
};

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  sextant::LinemodPeer peer;
  return sextant::run_peer(argc, argv, "linemod", peer);
}
