// SPDX-License-Identifier: Apache-2.0
// What sensors do to a frame, one family each: the printed box on a table among other things, found by a
// model that was learnt for it, with one fault at a time. Scenes are rendered; the faults are applied to
// clean frames.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "offline/learn/bin_layout.h"
#include "offline/learn/compile.h"
#include "offline/learn/scenery.h"
#include "offline/render/renderer.h"
#include "offline/synthesize/depth_sensor.h"
#include "runtime/detect/detector.h"
#include "runtime/geometry/pose_mapping.h"
#include "tests/support/rendered_frame.h"

namespace sextant {
namespace {

constexpr int kScenes = 5;
constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// A frame whose answer is known. `mask`: pixels of the object.
struct KnownFrame {
  RgbdFrame frame;
  cv::Mat mask;
  RigidTransform camera_from_object = RigidTransform::Identity();
};

class Robustness : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    LearnParameters p;
    p.images_per_bin = 30;
    p.scenes_per_bin = 24;
    p.grid = 48;
    p.min_pitch_deg = p.max_pitch_deg = 40;
    p.max_roll_deg = 0;
    p.angle_tolerance_deg = 4;
    p.min_distance_m = 0.6;
    p.max_distance_m = 1.1;
    p.camera = {kWidth, kHeight, 400, 159.5, 119.5};
    MeshOptions mesh;
    mesh.metres_per_unit = 0.001;
    mesh.up = "z";
    object_ = std::make_unique<StandingObject>(load_standing_object(
        std::filesystem::path(SEXTANT_SOURCE_DIR) / "data/meshes/printed_box.obj", mesh));
    auto boxes = lay_out_bins(p, 360);
    // Four sides are enough here.
    std::erase_if(boxes, [](const RotationBox& b) { return b.lo_deg[2] < 20 || b.hi_deg[2] > 100; });
    model_ = std::make_unique<ObjectModel>(
        assemble_model(*object_, p, learn_bins(*object_, p, boxes, 0, 0, 1, {}), "printed_box.obj", 7));
    make_frames(p.camera);
  }
  static void TearDownTestSuite() {
    model_.reset();
    object_.reset();
    frames_.clear();
  }

  static void make_frames(const PinholeCamera& camera) {
    Renderer renderer;
    const Scenery scenery(renderer);
    const int mesh = renderer.upload(object_->mesh);
    Random random(31);
    for (int i = 0; i < kScenes; ++i) {
      const TableGeometry table = TableGeometry::from_pitch_roll(40 * std::numbers::pi / 180, 0, 0.6);
      const double x = random.uniform(110, 210);
      const double y = random.uniform(100, 140);
      const UprightPose up = upright_pose_at(camera, table.up_in_camera, x, y);
      const double z = (0.6 - object_->centre_height_m) / up.sine_of_elevation;
      const double rz = random.uniform(30, 90) * std::numbers::pi / 180;
      KnownFrame known;
      known.camera_from_object = transform_from_pose(camera, {x, y, z, up.rx, up.ry, rz});
      const RigidTransform foot =
          known.camera_from_object * Eigen::Translation3d(0, 0, -object_->centre_height_m);
      std::vector<RenderItem> items{{mesh, known.camera_from_object}};
      const auto top = static_cast<std::size_t>(random.integer(0, 9));
      items.push_back({scenery.textured_tables.at(top), foot});
      for (const double side : {-1.0, 1.0}) {
        const auto thing = static_cast<std::size_t>(random.integer(0, 19));
        const double away = object_->bounding_radius_m + scenery.things.at(thing).radius_m + 0.02;
        items.push_back({scenery.things.at(thing).mesh, foot * Eigen::Translation3d(side * away, 0.03, 0)});
      }
      const RenderedView view =
          renderer.render(camera, {0, 0, kWidth, kHeight}, items, {{-0.5, -1, 0}, 0.5}, {150, 140, 130});
      known.frame = frame_of(view, camera, table);
      known.mask = view.item == 0;
      frames_.push_back(std::move(known));
    }
  }

  using Fault = std::function<void(KnownFrame&)>;

  /// Number of scenes whose box is found within 1 cm and 15 deg after `fault`.
  static int right_after(const Fault& fault) {
    DetectOptions options;
    options.tolerance.angle_rad = 0.07;
    Detector detector({*model_}, options);
    int right = 0;
    for (KnownFrame known : frames_) {
      known.frame.colour = known.frame.colour.clone();
      known.frame.axial_depth_m = known.frame.axial_depth_m.clone();
      fault(known);
      const FrameResult result = detector.detect(known.frame);
      if (result.estimates.empty()) continue;
      const RigidTransform found =
          result.estimates[0].camera_from_object * model_->object_from_mesh.inverse();
      const double off = (found.translation() - known.camera_from_object.translation()).norm();
      right += off < 0.01 && rotation_angle_between(found, known.camera_from_object) < 0.26;
    }
    return right;
  }

  static cv::Rect box_of(const KnownFrame& known) { return cv::boundingRect(known.mask); }

  static inline std::unique_ptr<StandingObject> object_;
  static inline std::unique_ptr<ObjectModel> model_;
  static inline std::vector<KnownFrame> frames_;
};

TEST_F(Robustness, CleanFrames) {
  EXPECT_EQ(right_after([](KnownFrame&) {}), kScenes);
}

TEST_F(Robustness, ColourAndDepthSeveralPixelsApart) {
  const auto fault = [](KnownFrame& k) {
    const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 3, 0, 1, -2);
    cv::warpAffine(k.frame.axial_depth_m, k.frame.axial_depth_m, shift, k.frame.colour.size(),
                   cv::INTER_NEAREST);
  };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

TEST_F(Robustness, ShadowsWithoutDepth) {
  const auto fault = [](KnownFrame& k) {
    DepthSensor sensor = depth_sensor("none");
    sensor.shadow_left_m = 0.07;
    sensor.edge_loss_px = 3;
    sensor.hole_share = 0.03;
    k.frame.axial_depth_m = apply_depth_sensor(k.frame.axial_depth_m, 400, sensor, 5);
  };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

TEST_F(Robustness, CoarseAndNoisyDepth) {
  const auto fault = [](KnownFrame& k) {
    k.frame.axial_depth_m = apply_depth_sensor(k.frame.axial_depth_m, 400, depth_sensor("kinect1"), 6);
  };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

TEST_F(Robustness, DarkAndBrightPictures) {
  EXPECT_GE(right_after([](KnownFrame& k) { k.frame.colour *= 0.4; }), kScenes - 1);
  EXPECT_GE(right_after([](KnownFrame& k) { k.frame.colour *= 1.7; }), kScenes - 1);
}

TEST_F(Robustness, BlurredPictures) {
  const auto fault = [](KnownFrame& k) { cv::GaussianBlur(k.frame.colour, k.frame.colour, {}, 1.8); };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

/// Something grey in front hides the left part of the object: 40 % of its pixels.
TEST_F(Robustness, PartlyHidden) {
  const auto fault = [](KnownFrame& k) {
    const cv::Rect box = box_of(k);
    const int wanted = cv::countNonZero(k.mask) * 2 / 5;
    int width = 1;
    while (cv::countNonZero(k.mask(cv::Rect(box.x, box.y, width, box.height))) < wanted) ++width;
    const cv::Rect hidden =
        cv::Rect(box.x - 30, box.y - 10, width + 30, box.height + 20) & cv::Rect(0, 0, kWidth, kHeight);
    double nearest = 0;
    cv::minMaxLoc(k.frame.axial_depth_m, &nearest, nullptr, nullptr, nullptr, k.mask);
    k.frame.axial_depth_m(hidden).setTo(nearest - 0.06);
    k.frame.colour(hidden).setTo(cv::Scalar(120, 110, 100));
  };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

/// The picture ends in the middle of the object: 20 % of its width are outside.
TEST_F(Robustness, CutByTheImageBorder) {
  const auto fault = [](KnownFrame& k) {
    const cv::Rect box = box_of(k);
    const int cut = box.x + box.width * 20 / 100;
    const cv::Rect rest(cut, 0, kWidth - cut, kHeight);
    k.frame.colour = k.frame.colour(rest).clone();
    k.frame.axial_depth_m = k.frame.axial_depth_m(rest).clone();
    k.frame.camera.width = rest.width;
    k.frame.camera.cx -= cut;
  };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

TEST_F(Robustness, ShinyObjectsWithoutDepth) {
  const auto fault = [](KnownFrame& k) { k.frame.axial_depth_m.setTo(0, k.mask); };
  EXPECT_GE(right_after(fault), kScenes - 1);
}

}  // namespace
}  // namespace sextant
