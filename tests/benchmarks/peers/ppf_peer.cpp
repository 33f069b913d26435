// SPDX-License-Identifier: Apache-2.0
// OpenCV contrib's point pair features (Drost et al., "Model globally, match locally", CVPR 2010) with the
// same table knowledge as ours: only points above the table are matched, candidates must stand on it.
#include <cmath>
#include <map>
#include <opencv2/surface_matching.hpp>
#include <opencv2/surface_matching/ppf_match_3d.hpp>

#include "tests/benchmarks/peers/candidate.h"

namespace sextant {
namespace {

constexpr double kSampling = 0.04;      ///< of the diameter
constexpr double kDistance = 0.05;      ///< of the diameter
constexpr double kSceneStep = 1.0 / 6;  ///< of the scene's points are reference points
constexpr double kTiltDeg = 15;
constexpr double kHeightM = 0.03;
constexpr std::size_t kVerified = 12;

class PpfPeer : public Peer {
 public:
  void learn(const PeerObject& object, const PinholeCamera& camera, const PeerRanges& ranges,
             Renderer& renderer) override {
    // The surface that the cameras can see, from all around.
    cv::Mat points(0, 6, CV_32FC1);
    const double distance = (ranges.min_distance_m + ranges.max_distance_m) / 2;
    for (int turn = 0; turn < 12; ++turn) {
      for (const double pitch : {ranges.min_pitch_deg, ranges.max_pitch_deg}) {
        const double elevation = pitch * M_PI / 180;
        RigidTransform pose = RigidTransform::Identity();
        pose.linear() = (Eigen::AngleAxisd(M_PI / 2 + elevation, Eigen::Vector3d::UnitX()) *
                         Eigen::AngleAxisd(turn * M_PI / 6, Eigen::Vector3d::UnitZ()))
                            .toRotationMatrix();
        pose.translation() = Eigen::Vector3d(0, 0, distance);
        points.push_back(visible_points(renderer, object, camera, pose, 3));
      }
    }
    cv::ppf_match_3d::PPF3DDetector detector(kSampling, kDistance);
    detector.trainModel(points);
    detectors_.emplace(object.id, detector);
  }

  std::optional<PeerAnswer> find(const PeerObject& object, const RgbdFrame& frame,
                                 const PinholeCamera& camera, Renderer& renderer) override {
    const double top = 2 * object.object.centre_height_m + 0.03;
    const cv::Mat scene = points_above_table(frame, camera, 0.006, top, 3);
    if (scene.rows < 100) return std::nullopt;
    std::vector<cv::ppf_match_3d::Pose3DPtr> poses;
    detectors_.at(object.id).match(scene, poses, kSceneStep, kDistance);
    std::optional<PeerAnswer> best;
    std::size_t verified = 0;
    for (const auto& candidate : poses) {
      RigidTransform pose = RigidTransform::Identity();
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 4; ++c) pose.matrix()(r, c) = candidate->pose(r, c);
      }
      if (!pose.matrix().allFinite() || pose.translation().z() < 0.2) continue;
      const TableGeometry& table = *frame.table;
      const double tilt = std::acos(std::clamp(pose.linear().col(2).dot(table.up_in_camera), -1.0, 1.0));
      const double height = table.up_in_camera.dot(pose.translation()) + table.camera_height_m;
      if (tilt > kTiltDeg * M_PI / 180 || std::abs(height - object.object.centre_height_m) > kHeightM)
        continue;
      pose = stood_on_table(pose, table, object.object.centre_height_m);
      pose = refined(renderer, object, camera, scene, pose, 0.03);
      pose = stood_on_table(pose, table, object.object.centre_height_m);
      const Agreement a = agreement(renderer, object, frame, camera, pose);
      const double score = a.depth * std::min(1.0, a.known / 0.5) + 0.2 * a.colour;
      if (!best || score > best->score) best = PeerAnswer{pose, score};
      if (++verified == kVerified) break;
    }
    return best;
  }

 private:
  std::map<int, cv::ppf_match_3d::PPF3DDetector> detectors_;
};

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  sextant::PpfPeer peer;
  return sextant::run_peer(argc, argv, "ppf", peer);
}
