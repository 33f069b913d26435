// SPDX-License-Identifier: Apache-2.0
// Random frames and models for property tests of the search: sparse edges, stepped depth with holes, parts
// that partly fall outside of the image.
#pragma once

#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>

#include "runtime/features/edges.h"
#include "runtime/search/constraint.h"
#include "runtime/search/scored_bin.h"
#include "runtime/tables/frame_tables.h"

namespace sextant {

class RandomProblem {
 public:
  explicit RandomProblem(std::uint64_t seed, int width = 72, int height = 56) : random_(seed) {
    camera_ = {width, height, 60, width / 2.0 - 0.5, height / 2.0 - 0.5};
    make_frame();
    make_model();
    ScoringOptions options(seed % 2 ? Scoring::kThesis : Scoring::kLikelihood);
    options.outside_is_unknown = seed % 4 == 0;
    bins_ = score_bins(model_, options);
  }

  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  int whole(int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(random_); }

  /// A table that the camera looks down on.
  TableConstraint table() {
    return {TableGeometry::from_pitch_roll(uniform(0.4, 1.0), uniform(-0.2, 0.2), uniform(0.6, 1.0)),
            {0.03, 6 * kOneDegree},
            0.05};
  }

  /// A random box of lattice poses inside a bin, at most `most` long in each dimension.
  Region region(int most) {
    Region r;
    r.bin = whole(0, static_cast<int>(bins_.size()) - 1);
    const RotationBox& box = bins_[static_cast<std::size_t>(r.bin)].box;
    const auto z_index = [](double z_m) { return static_cast<int>(std::lround(z_m / kLatticeDistance)); };
    const std::array<int, 6> lo{0,
                                0,
                                z_index(0.4),
                                first_angle(box.lo_deg[0]),
                                first_angle(box.lo_deg[1]),
                                first_angle(box.lo_deg[2])};
    const std::array<int, 6> hi{
        camera_.width - 1,         camera_.height - 1,        z_index(1.4),
        last_angle(box.hi_deg[0]), last_angle(box.hi_deg[1]), last_angle(box.hi_deg[2])};
    for (std::size_t d = 0; d < 6; ++d) {
      const int a = whole(lo[d], hi[d]);
      r.lo[d] = static_cast<std::int16_t>(a);
      r.hi[d] = static_cast<std::int16_t>(std::min(hi[d], a + whole(0, most)));
    }
    return r;
  }
  LatticePose pose_in(const Region& r) {
    LatticePose p{r.bin, {}};
    for (std::size_t d = 0; d < 6; ++d) p.at[d] = static_cast<std::int16_t>(whole(r.lo[d], r.hi[d]));
    return p;
  }

  const PinholeCamera& camera() const { return camera_; }
  const FrameTables& tables() const { return tables_; }
  const ObjectModel& model() const { return model_; }
  const std::vector<ScoredBin>& bins() const { return bins_; }
  const cv::Mat& edges() const { return edges_; }
  const SearchFrame& frame() const { return frame_; }

 private:
  void make_frame() {
    frame_.camera = camera_;
    frame_.ray_depth_m.create(camera_.height, camera_.width, CV_32FC1);
    frame_.colour = cv::Mat::zeros(camera_.height, camera_.width, CV_8UC3);
    edges_ = cv::Mat::zeros(camera_.height, camera_.width, CV_8UC1);
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        frame_.ray_depth_m.at<float>(y, x) = static_cast<float>(1.0 - 0.004 * y + uniform(-0.003, 0.003));
      }
    }
    for (int i = 0; i < 12; ++i) {
      const cv::Rect r(whole(0, camera_.width - 8), whole(0, camera_.height - 8), whole(3, 24), whole(3, 24));
      const double depth = i % 3 == 0 ? 0 : uniform(0.6, 1.0);
      cv::rectangle(frame_.ray_depth_m, r, cv::Scalar(depth), cv::FILLED);
      cv::rectangle(frame_.colour, r, cv::Scalar(uniform(0, 255), uniform(0, 255), uniform(0, 255)),
                    cv::FILLED);
    }
    edges_ = edges_by_direction(frame_.colour);
    WorkerPool serial(1);
    tables_.build(frame_, edges_, 30, serial);
  }

  void make_model() {
    model_.bounding_radius_m = 0.1;
    model_.centre_height_m = 0.05;
    for (int k = 0; k < 3; ++k) {
      ViewpointBin bin;
      bin.box = {{-10, -50, 12 * k}, {10, -30, 12 * (k + 1)}};
      const auto coefficient = [this](double size) { return static_cast<float>(uniform(-size, size)); };
      for (int i = 0; i < 12 + 3 * k; ++i) {
        VisualPart v;
        v.kind = static_cast<std::uint8_t>(whole(0, 7));
        v.u = {coefficient(0.1), coefficient(0.1), coefficient(0.1), coefficient(0.1)};
        v.v = {coefficient(0.1), coefficient(0.1), coefficient(0.1), coefficient(0.1)};
        v.variance = static_cast<float>(uniform(1, 20) / (525 * 525));
        v.radius = static_cast<float>(uniform(2, 8) / 60);
        bin.visual.push_back(v);
        DepthPart d;
        d.px = coefficient(0.1);
        d.py = coefficient(0.1);
        d.d = {coefficient(0.1), coefficient(0.05), coefficient(0.05), coefficient(0.05)};
        d.variance = static_cast<float>(uniform(1e-6, 4e-5));
        d.radius = 0.02F;
        d.missing = 0.01F;
        bin.depth.push_back(d);
      }
      bin.extent = {-0.08F, -0.1F, 0.09F, 0.1F};
      model_.bins.push_back(bin);
    }
  }

  std::mt19937_64 random_;
  PinholeCamera camera_;
  SearchFrame frame_;
  cv::Mat edges_;
  FrameTables tables_;
  ObjectModel model_;
  std::vector<ScoredBin> bins_;
};

}  // namespace sextant
