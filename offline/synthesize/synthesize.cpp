// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/synthesize.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "offline/dataset/bop_writer.h"
#include "offline/synthesize/colour_sensor.h"
#include "offline/synthesize/depth_sensor.h"
#include "offline/synthesize/lighting.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr int kSceneId = 1;
const Eigen::Vector3d kBackground(96, 98, 102);

/// Streams of random numbers of one image.
enum Stream : std::uint64_t { kComposition, kDepth, kColour };

Footprint footprint_of(const StandingObject& object) {
  Footprint footprint;
  footprint.bounding_radius_m = object.bounding_radius_m;
  footprint.centre_height_m = object.centre_height_m;
  for (const Eigen::Vector3f& v : object.mesh.vertices) {
    footprint.horizontal_radius_m = std::max<double>(footprint.horizontal_radius_m, v.head<2>().norm());
  }
  return footprint;
}

cv::Mat axial_depth(const cv::Mat& ray_depth_m, const PinholeCamera& camera) {
  cv::Mat axial(ray_depth_m.size(), CV_32FC1);
  for (int y = 0; y < axial.rows; ++y) {
    for (int x = 0; x < axial.cols; ++x) {
      axial.at<float>(y, x) = static_cast<float>(ray_depth_m.at<float>(y, x) * camera.ray(x, y).z());
    }
  }
  return axial;
}

/// Meshes on the GPU for as long as one scene needs them.
class UploadedSurroundings {
 public:
  UploadedSurroundings(Renderer& renderer, const TableScene& scene) : renderer_(renderer) {
    for (const PlacedMesh& placed : scene.surroundings) {
      items_.push_back({renderer.upload(placed.mesh), scene.camera_from_world * placed.world_from_mesh});
    }
  }
  ~UploadedSurroundings() {
    for (const RenderItem& item : items_) renderer_.release(item.mesh);
  }
  UploadedSurroundings(const UploadedSurroundings&) = delete;
  UploadedSurroundings& operator=(const UploadedSurroundings&) = delete;
  const std::vector<RenderItem>& items() const { return items_; }

 private:
  Renderer& renderer_;
  std::vector<RenderItem> items_;
};

/// What the whole picture and the object alone say about its visibility.
BopInstance measure_instance(Renderer& renderer, const PinholeCamera& camera, const RenderItem& item,
                             int index, const RenderedView& view) {
  const cv::Rect picture(0, 0, camera.width, camera.height);
  const RenderedView alone = renderer.render(camera, picture, {item}, {}, kBackground);
  const cv::Mat all = alone.item == 0;
  const cv::Mat seen = view.item == index;
  BopInstance instance;
  instance.bbox_object = cv::boundingRect(all);
  instance.bbox_visible = cv::boundingRect(seen);
  instance.pixels_all = cv::countNonZero(all);
  instance.pixels_visible = cv::countNonZero(seen);
  return instance;
}

struct SyntheticImage {
  RgbdFrame frame;
  std::vector<BopInstance> instances;
};

class Synthesizer {
 public:
  Synthesizer(const std::vector<SynthesisTarget>& targets, const SynthesisOptions& options)
      : targets_(targets), options_(options), sensor_(depth_sensor(options.sensor)) {
    for (const SynthesisTarget& target : targets) {
      meshes_.push_back(renderer_.upload(target.object.mesh));
      footprints_.push_back(footprint_of(target.object));
    }
  }

  SyntheticImage make(int image) {
    const std::uint64_t seed = derived_seed(options_.seed, static_cast<std::uint64_t>(image));
    Random random(derived_seed(seed, kComposition));
    std::vector<std::size_t> chosen;
    chosen.reserve(targets_.size());
    for (int i = 0; i < options_.targets_per_image; ++i) {
      chosen.push_back(static_cast<std::size_t>(image + i) % targets_.size());
    }
    constexpr int kAttempts = 30;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      if (auto made = try_make(chosen, seed, random)) return std::move(*made);
    }
    throw UsageError("no scene was found in which the objects are seen well enough",
                     "lower --min-visible or --clutter");
  }

 private:
  std::optional<SyntheticImage> try_make(const std::vector<std::size_t>& chosen, std::uint64_t seed,
                                         Random& random) {
    const PinholeCamera& camera = options_.scene.camera;
    std::vector<Footprint> footprints;
    footprints.reserve(chosen.size());
    for (const std::size_t i : chosen) footprints.push_back(footprints_[i]);
    const TableScene scene = compose_scene(options_.scene, footprints, random);
    const UploadedSurroundings surroundings(renderer_, scene);
    std::vector<RenderItem> items;
    items.reserve(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      items.push_back({meshes_[chosen[i]], scene.camera_from_world * scene.world_from_target[i]});
    }
    const std::vector<RenderItem> target_items = items;
    items.insert(items.end(), surroundings.items().begin(), surroundings.items().end());
    Light light;
    light.position_in_camera = scene.camera_from_world * scene.light_in_world;
    light.ambient = scene.ambient;
    const RenderedView view =
        render_with_shadows(renderer_, camera, items, light, kBackground,
                            target_items[0].camera_from_mesh.translation(), 0.8, random.integer(1, 3));

    SyntheticImage result;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const StandingObject& object = targets_[chosen[i]].object;
      BopInstance instance = measure_instance(renderer_, camera, target_items[i], static_cast<int>(i), view);
      if (instance.pixels_visible < options_.scene.min_visible * instance.pixels_all ||
          instance.pixels_all == 0) {
        return std::nullopt;
      }
      instance.object_id = targets_[chosen[i]].object_id;
      instance.camera_from_mesh = target_items[i].camera_from_mesh * object.object_from_mesh;
      result.instances.push_back(instance);
    }
    RgbdFrame& frame = result.frame;
    frame.camera.width = camera.width;
    frame.camera.height = camera.height;
    frame.camera.fx = frame.camera.fy = camera.focal;
    frame.camera.cx = camera.cx;
    frame.camera.cy = camera.cy;
    frame.table = scene.table;
    frame.axial_depth_m = apply_depth_sensor(axial_depth(view.ray_depth_m, camera), camera.focal, sensor_,
                                             derived_seed(seed, kDepth));
    frame.colour = sensor_.name == "none" ? view.colour
                                          : apply_colour_sensor(view.colour, {}, derived_seed(seed, kColour));
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      result.instances[i].pixels_valid =
          cv::countNonZero((view.item == static_cast<int>(i)) & (frame.axial_depth_m > 0));
    }
    return result;
  }

  const std::vector<SynthesisTarget>& targets_;
  const SynthesisOptions& options_;
  DepthSensor sensor_;
  Renderer renderer_;
  std::vector<int> meshes_;
  std::vector<Footprint> footprints_;
};

void check(const std::vector<SynthesisTarget>& targets, const SynthesisOptions& options) {
  if (targets.empty()) throw UsageError("give at least one mesh or model");
  if (options.images < 1 || options.images > 1'000'000)
    throw UsageError("--images must lie between 1 and 1000000");
  if (options.targets_per_image < 1 || options.targets_per_image > static_cast<int>(targets.size())) {
    throw UsageError("--objects-per-image must lie between 1 and the number of objects given");
  }
  for (std::size_t i = 0; i < targets.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (targets[i].object_id == targets[j].object_id) {
        throw UsageError("two objects have the id " + std::to_string(targets[i].object_id),
                         "give --object-id for each");
      }
    }
  }
  const auto ordered = [](const Range& r, double lo, double hi, const char* name) {
    if (!(r.lo >= lo && r.lo <= r.hi && r.hi <= hi))
      throw UsageError(std::string(name) + " is no range inside its limits");
  };
  ordered(options.scene.pitch_deg, 5, 85, "the pitch");
  ordered(options.scene.roll_deg, -180, 180, "the roll");
  ordered(options.scene.height_m, 0.1, 10, "the height");
  ordered(options.scene.distance_m, 0.1, 20, "the distance");
  ordered(options.scene.clutter, 0, 100, "the number of clutter objects");
}

}  // namespace

SynthesisSummary synthesize_dataset(const std::vector<SynthesisTarget>& targets,
                                    const SynthesisOptions& options,
                                    const std::function<void(std::size_t, std::size_t)>& progress) {
  check(targets, options);
  Synthesizer synthesizer(targets, options);
  BopWriter writer(options.output);
  for (const SynthesisTarget& target : targets) writer.add_model(target.object_id, target.object);
  SynthesisSummary summary;
  for (int image = 0; image < options.images; ++image) {
    const SyntheticImage made = synthesizer.make(image);
    writer.add_image(kSceneId, image, made.frame, made.instances);
    for (const BopInstance& instance : made.instances) {
      summary.mean_visible_fraction += static_cast<double>(instance.pixels_visible) / instance.pixels_all;
      ++summary.instances;
    }
    ++summary.images;
    if (progress) progress(static_cast<std::size_t>(image) + 1, static_cast<std::size_t>(options.images));
  }
  writer.finish();
  if (summary.instances > 0) summary.mean_visible_fraction /= summary.instances;
  return summary;
}

StandingObject standing_object_of(const ObjectModel& model) {
  StandingObject object;
  MeshPart part;
  for (const auto& triangle : model.mesh.triangles) {
    std::array<Eigen::Vector3f, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = model.mesh.vertices.at(triangle[i]);
    const Eigen::Vector3f normal = (p[1] - p[0]).cross(p[2] - p[0]);
    if (!(normal.norm() > 0)) continue;
    const auto first = static_cast<std::uint32_t>(object.mesh.vertices.size());
    for (const Eigen::Vector3f& corner : p) {
      object.mesh.vertices.push_back(corner);
      object.mesh.normals.emplace_back(normal.normalized());
      object.mesh.colours.emplace_back(0.7F, 0.7F, 0.7F);
      object.mesh.uvs.emplace_back(0, 0);
    }
    part.triangles.push_back({first, first + 1, first + 2});
  }
  if (part.triangles.empty())
    throw InputError(model.name, "this model holds no mesh", "give the mesh instead");
  object.mesh.parts.push_back(std::move(part));
  object.object_from_mesh = model.object_from_mesh;
  object.bounding_radius_m = model.bounding_radius_m;
  object.centre_height_m = model.centre_height_m;
  object.symmetry_deg = model.symmetry_deg;
  object.geometric_symmetry_deg = model.geometric_symmetry_deg;
  return object;
}

}  // namespace sextant
