// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/synthesizer.h"

#include <algorithm>
#include <cmath>

#include "offline/synthesize/colour_sensor.h"
#include "offline/synthesize/depth_sensor.h"
#include "offline/synthesize/lighting.h"
#include "offline/synthesize/visibility.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

const Eigen::Vector3d kBackground(96, 98, 102);

/// Half a per cent of the silhouette above the range is forgiven: the search for a scene sees fewer pixels.
constexpr double kOcclusionSlack = 0.005;

/// Streams of random numbers of one image.
enum Stream : std::uint64_t { kComposition, kDepth, kColour };

Footprint footprint_of(const StandingObject& object) {
  Footprint footprint;
  footprint.bounding_radius_m = object.bounding_radius_m;
  footprint.centre_height_m = object.centre_height_m;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9F);
  Eigen::Vector3f high = -low;
  for (const Eigen::Vector3f& v : object.mesh.vertices) {
    footprint.horizontal_radius_m = std::max<double>(footprint.horizontal_radius_m, v.head<2>().norm());
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  footprint.size_m = (high - low).cast<double>();
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

/// Half the pixels a side, the same view: visibility is searched for in it.
PinholeCamera halved(const PinholeCamera& camera) {
  return {camera.width / 2, camera.height / 2, camera.focal / 2, (camera.cx - 0.5) / 2,
          (camera.cy - 0.5) / 2};
}

}  // namespace

struct Synthesizer::Impl {
  const std::vector<SynthesisTarget>& targets;
  const ImageOptions& options;
  TextureLibrary& textures;
  DepthSensor sensor;
  Renderer renderer;
  std::vector<int> target_meshes, distractor_meshes;
  std::vector<Footprint> target_footprints, distractor_footprints;
  std::vector<int>
      uploaded;  ///< meshes of the scene under construction, one per surrounding; -1: not its own

  Impl(const std::vector<SynthesisTarget>& t, const std::vector<StandingObject>& distractors,
       const ImageOptions& o, TextureLibrary& library)
      : targets(t), options(o), textures(library), sensor(depth_sensor(o.sensor)) {
    if (o.misregistration_px)
      sensor.misregistration_px = *o.misregistration_px * sensor.focal_px / o.scene.camera.focal;
    for (const SynthesisTarget& target : targets) {
      target_meshes.push_back(renderer.upload(target.object.mesh));
      target_footprints.push_back(footprint_of(target.object));
    }
    for (const StandingObject& object : distractors) {
      distractor_meshes.push_back(renderer.upload(object.mesh));
      distractor_footprints.push_back(footprint_of(object));
    }
  }

  void forget_scene() {
    for (const int mesh : uploaded) {
      if (mesh >= 0) renderer.release(mesh);
    }
    uploaded.clear();
  }

  /// Targets first, then the surroundings in their order; uploads what is new.
  std::vector<RenderItem> items_of(const TableScene& scene, const std::vector<std::size_t>& chosen,
                                   const std::vector<double>& gloss) {
    std::vector<RenderItem> items;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      items.push_back(
          {target_meshes[chosen[i]], scene.camera_from_world * scene.world_from_target[i], gloss[i]});
    }
    for (std::size_t i = 0; i < scene.surroundings.size(); ++i) {
      const PlacedMesh& placed = scene.surroundings[i];
      if (i == uploaded.size())
        uploaded.push_back(placed.distractor >= 0 ? -1 : renderer.upload(placed.mesh));
      const int mesh = placed.distractor >= 0 ? distractor_meshes[static_cast<std::size_t>(placed.distractor)]
                                              : uploaded[i];
      items.push_back({mesh, scene.camera_from_world * placed.world_from_mesh, placed.gloss});
    }
    return items;
  }

  void remove(TableScene& scene, std::size_t surrounding) {
    if (uploaded[surrounding] >= 0) renderer.release(uploaded[surrounding]);
    uploaded.erase(uploaded.begin() + static_cast<std::ptrdiff_t>(surrounding));
    remove_clutter(scene, surrounding);
  }

  std::vector<Visibility> visibilities(const PinholeCamera& camera, const std::vector<RenderItem>& items,
                                       const std::vector<std::size_t>& chosen, const RenderedView& view) {
    std::vector<Visibility> result;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      result.push_back(measure_visibility(renderer, camera, items, i,
                                          target_footprints[chosen[i]].bounding_radius_m, view));
    }
    return result;
  }

  bool cut_enough(const TableScene& scene, std::size_t i, const Visibility& v) const {
    if (v.all == 0) return false;
    return !scene.cut[i] || v.inside >= options.scene.cut_visible * v.all;
  }

  /// Takes something of the clutter away, whatever it is; false where there is none.
  bool make_room(TableScene& scene, Random& random) {
    const std::size_t count = scene.surroundings.size() - scene.first_clutter;
    if (count == 0) return false;
    const int which = random.integer(0, static_cast<int>(count) - 1);
    remove(scene, scene.first_clutter + static_cast<std::size_t>(which));
    return true;
  }

  /// Takes clutter away and puts occluders in until every target is hidden as much as is wanted.
  bool arrange(TableScene& scene, const std::vector<std::size_t>& chosen, const ClutterStock& stock,
               Random& random) {
    constexpr int kRounds = 40;
    const Range& wanted = options.scene.occlusion;
    const PinholeCamera camera = halved(options.scene.camera);
    const std::vector<double> gloss(chosen.size(), 0);
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<RenderItem> items = items_of(scene, chosen, gloss);
      const RenderedView view = renderer.render_geometry(camera, {0, 0, camera.width, camera.height}, items);
      bool changed = false;
      const std::vector<Visibility> seen = visibilities(camera, items, chosen, view);
      for (std::size_t i = 0; i < chosen.size() && !changed; ++i) {
        if (!cut_enough(scene, i, seen[i])) return false;
        // A little inside of the range: the whole picture counts more finely.
        const double slack = 0.05 * (wanted.hi - wanted.lo);
        if (seen[i].occlusion() > wanted.hi - slack && seen[i].worst_hider >= 0) {
          const auto first = chosen.size() + scene.first_clutter;
          const auto hider = static_cast<std::size_t>(seen[i].worst_hider);
          if (hider < first) {
            if (seen[i].occlusion() > wanted.hi) return false;  // another target, or the room
            continue;
          }
          remove(scene, hider - chosen.size());
          changed = true;
        } else if (seen[i].occlusion() < wanted.lo + slack && wanted.lo > 0) {
          const double lacking = random.uniform(wanted.lo + slack, wanted.hi - slack) - seen[i].occlusion();
          const bool added =
              add_occluder(scene, i, target_footprints[chosen[i]], std::max(0.05, lacking), stock, random);
          if (!added && !make_room(scene, random)) return false;
          changed = true;
        }
      }
      if (!changed) return true;
    }
    return false;
  }

  std::optional<SyntheticImage> try_make(const std::vector<std::size_t>& chosen, std::uint64_t seed,
                                         Random& random);
};

Synthesizer::Synthesizer(const std::vector<SynthesisTarget>& targets,
                         const std::vector<StandingObject>& distractors, const ImageOptions& options,
                         TextureLibrary& textures)
    : impl_(std::make_unique<Impl>(targets, distractors, options, textures)) {}
Synthesizer::~Synthesizer() = default;

SyntheticImage Synthesizer::make(int number) {
  const ImageOptions& options = impl_->options;
  const std::uint64_t seed = derived_seed(options.seed, static_cast<std::uint64_t>(number));
  Random random(derived_seed(seed, kComposition));
  std::vector<std::size_t> chosen;
  if (number < options.images) {
    for (int i = 0; i < options.targets_per_image; ++i) {
      const auto which = static_cast<std::size_t>(number + i) % impl_->targets.size();
      const int count =
          random.integer(static_cast<int>(options.instances.lo), static_cast<int>(options.instances.hi));
      chosen.insert(chosen.end(), static_cast<std::size_t>(count), which);
    }
  }
  constexpr int kAttempts = 60;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    auto made = impl_->try_make(chosen, seed, random);
    impl_->forget_scene();
    if (made) return std::move(*made);
  }
  throw UsageError("no scene was found in which the objects are seen as wanted",
                   "widen --occlusion, lower --clutter, or put fewer objects into one image");
}

std::optional<SyntheticImage> Synthesizer::Impl::try_make(const std::vector<std::size_t>& chosen,
                                                          std::uint64_t seed, Random& random) {
  const PinholeCamera& camera = options.scene.camera;
  std::vector<Footprint> footprints;
  for (const std::size_t i : chosen) footprints.push_back(target_footprints[i]);
  const ClutterStock stock{textures, target_footprints, distractor_footprints, options.scene.decoy_share,
                           options.scene.distractor_share};
  TableScene scene = compose_scene(options.scene, footprints, stock, random);
  std::vector<double> gloss;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const bool shines = random.chance(0.4);
    const double strength = random.uniform(0.05, 0.5);
    gloss.push_back(shines ? strength : 0);
  }
  if (!arrange(scene, chosen, stock, random)) return std::nullopt;

  const std::vector<RenderItem> items = items_of(scene, chosen, gloss);
  Light light;
  light.position_in_camera = scene.camera_from_world * scene.light_in_world;
  light.ambient = scene.ambient;
  for (const SceneLight& fill : scene.fills)
    light.fills.push_back({scene.camera_from_world * fill.p_in_world, fill.strength});
  const Eigen::Vector3d focus = chosen.empty()
                                    ? Eigen::Vector3d(scene.camera_from_world * Eigen::Vector3d(0, 0.7, 0))
                                    : Eigen::Vector3d(items[0].camera_from_mesh.translation());
  const RenderedView view =
      render_with_shadows(renderer, camera, items, light, kBackground, focus, 0.8, random.integer(1, 3));

  SyntheticImage result;
  DepthSurfaces surfaces;
  surfaces.object = view.item.clone();
  const std::vector<Visibility> seen = visibilities(camera, items, chosen, view);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double occlusion = seen[i].occlusion();
    if (!cut_enough(scene, i, seen[i]) || occlusion < options.scene.occlusion.lo ||
        occlusion > options.scene.occlusion.hi + kOcclusionSlack) {
      return std::nullopt;
    }
    BopInstance instance;
    instance.object_id = targets[chosen[i]].object_id;
    instance.camera_from_mesh = items[i].camera_from_mesh * targets[chosen[i]].object.object_from_mesh;
    instance.bbox_object = seen[i].box_all;
    instance.bbox_visible = seen[i].box_visible;
    instance.pixels_all = seen[i].all;
    instance.pixels_visible = seen[i].visible;
    result.instances.push_back(instance);
    if (random.chance(options.no_depth_share)) surfaces.no_depth.push_back(static_cast<int>(i));
  }
  const auto room_begin = static_cast<int>(chosen.size());
  const auto room_end = static_cast<int>(chosen.size() + scene.first_clutter);
  surfaces.object.setTo(-1, (view.item >= room_begin) & (view.item < room_end));

  RgbdFrame& frame = result.frame;
  frame.camera.width = camera.width;
  frame.camera.height = camera.height;
  frame.camera.fx = frame.camera.fy = camera.focal;
  frame.camera.cx = camera.cx;
  frame.camera.cy = camera.cy;
  frame.table = scene.table;
  frame.axial_depth_m = apply_depth_sensor(axial_depth(view.ray_depth_m, camera), camera.focal, sensor,
                                           derived_seed(seed, kDepth), surfaces);
  frame.colour =
      sensor.name == "none" ? view.colour : apply_colour_sensor(view.colour, {}, derived_seed(seed, kColour));
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    result.instances[i].pixels_valid =
        cv::countNonZero((view.item == static_cast<int>(i)) & (frame.axial_depth_m > 0));
  }
  return result;
}

void check_image_options(const std::vector<SynthesisTarget>& targets, const ImageOptions& options) {
  if (targets.empty()) throw UsageError("give at least one mesh or model");
  if (options.images < 0 || options.negatives < 0 || options.images + options.negatives < 1 ||
      options.images > 1'000'000 || options.negatives > 1'000'000)
    throw UsageError("--images and --negatives must lie between 0 and 1000000, not both 0");
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
  ordered(options.scene.occlusion, 0, 0.95, "the occlusion (0..0.95)");
  ordered(options.instances, 1, 10, "the number of instances (1..10)");
}

}  // namespace sextant
