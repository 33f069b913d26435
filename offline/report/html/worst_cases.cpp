// SPDX-License-Identifier: Apache-2.0
#include "offline/report/html/worst_cases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "hal/image/image_file.h"
#include "offline/report/silhouette.h"

namespace sextant {
namespace {

constexpr int kPictureWidth = 420;  ///< pixels, about
const cv::Scalar kTruth(0, 214, 105);
const cv::Scalar kAnswer(255, 20, 160);

struct Outline {
  const RigidTransform* pose;
  cv::Scalar colour;
};

/// The part of the frame around the outlines, enlarged, with the outlines on it.
std::string picture_of(const RgbdFrame& frame, const ModelMesh& mesh, const std::vector<Outline>& outlines) {
  cv::Rect region;
  for (const Outline& outline : outlines) {
    const cv::Rect box = cv::boundingRect(silhouette_mask(mesh, frame.camera, *outline.pose));
    region = region.empty() ? box : region | box;
  }
  const cv::Rect whole(0, 0, frame.camera.width, frame.camera.height);
  if (region.empty()) region = whole;
  // A margin of a third, and the 4:3 of the page's frames.
  const double height = std::max({1.7 * region.height, 1.7 * region.width * 0.75, 90.0});
  const cv::Point middle = (region.tl() + region.br()) / 2;
  const cv::Size size(static_cast<int>(height / 0.75), static_cast<int>(height));
  region = cv::Rect(middle - cv::Point(size.width / 2, size.height / 2), size);
  region.x = std::clamp(region.x, 0, std::max(0, whole.width - region.width));
  region.y = std::clamp(region.y, 0, std::max(0, whole.height - region.height));
  region &= whole;
  const int scale = std::clamp((kPictureWidth + region.width - 1) / region.width, 1, 6);
  cv::Mat picture;
  cv::resize(frame.colour(region), picture, {}, scale, scale, cv::INTER_CUBIC);
  const cv::Rect enlarged(region.tl() * scale, region.size() * scale);
  for (const Outline& outline : outlines) {
    const cv::Mat mask = silhouette_mask(mesh, frame.camera, *outline.pose, scale)(enlarged).clone();
    std::vector<std::vector<cv::Point>> lines;
    cv::findContours(mask, lines, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    cv::polylines(picture, lines, true, cv::Scalar(15, 15, 20), 4, cv::LINE_AA);
    cv::polylines(picture, lines, true, outline.colour, 2, cv::LINE_AA);
  }
  const std::vector<std::byte> bytes = encode_jpeg(picture, 82);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

double badness(const InstanceResult& r, const EvaluationOptions& options) {
  if (!r.found) return HUGE_VAL;
  return std::max(r.translation_cm / options.max_translation_cm, r.rotation_deg / options.max_rotation_deg);
}

}  // namespace

std::vector<const InstanceResult*> worst_instances(const EvaluationReport& report) {
  std::vector<const InstanceResult*> worst;
  for (const InstanceResult& r : report.instances) {
    if (!r.right) worst.push_back(&r);
  }
  std::stable_sort(worst.begin(), worst.end(), [&](const InstanceResult* a, const InstanceResult* b) {
    return badness(*a, report.options) > badness(*b, report.options);
  });
  return worst;
}

std::vector<CasePicture> worst_case_pictures(const EvaluationReport& report,
                                             const std::vector<BopImage>& images,
                                             const std::map<int, ModelMesh>& meshes, std::size_t limit) {
  std::map<std::pair<int, int>, const BopImage*> by_number;
  for (const BopImage& image : images) by_number[{image.scene_id, image.image_id}] = &image;
  std::vector<CasePicture> pictures;
  const auto add = [&](int scene, int image, int object, const std::vector<Outline>& outlines,
                       const std::string& what) {
    const auto mesh = meshes.find(object);
    const auto file = by_number.find({scene, image});
    if (pictures.size() >= limit || mesh == meshes.end() || file == by_number.end()) return;
    const RgbdFrame frame = load_frame(*file->second);
    pictures.push_back({fmt::format("scene {}, image {}, object {}: {}", scene, image, object, what),
                        picture_of(frame, mesh->second, outlines)});
  };
  for (const InstanceResult* r : worst_instances(report)) {
    std::vector<Outline> outlines{{&r->truth, kTruth}};
    if (r->found) outlines.push_back({&r->estimate, kAnswer});
    const std::string what = r->found
                                 ? fmt::format("{:.1f} cm and {:.0f}° off, score {:.3g}, {:.0f} % visible",
                                               r->translation_cm, r->rotation_deg, r->score, 100 * r->visible)
                                 : fmt::format("not found, {:.0f} % visible", 100 * r->visible);
    add(r->scene_id, r->image_id, r->object_id, outlines, what);
  }
  std::vector<const FalseAnswer*> alarms;
  for (const FalseAnswer& alarm : report.false_answers) alarms.push_back(&alarm);
  std::stable_sort(alarms.begin(), alarms.end(),
                   [](const FalseAnswer* a, const FalseAnswer* b) { return a->score > b->score; });
  for (const FalseAnswer* alarm : alarms) {
    add(alarm->scene_id, alarm->image_id, alarm->object_id, {{&alarm->estimate, kAnswer}},
        fmt::format("false alarm, score {:.3g}", alarm->score));
  }
  return pictures;
}

}  // namespace sextant
