// SPDX-License-Identifier: Apache-2.0
#include "offline/synthesize/synthesize.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>

#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr int kSceneId = 1;

}  // namespace

SynthesisSummary synthesize_dataset(const std::vector<SynthesisTarget>& targets,
                                    const std::vector<StandingObject>& distractors,
                                    const SynthesisOptions& options,
                                    const std::function<void(std::size_t, std::size_t)>& progress) {
  check_image_options(targets, options);
  const int total = options.images + options.negatives;
  TextureLibrary textures(options.seed);
  BopWriter writer(options.output);
  for (const SynthesisTarget& target : targets) writer.add_model(target.object_id, target.object);

  SynthesisSummary summary;
  std::vector<double> visible(static_cast<std::size_t>(total));  // per image: the sum keeps its order
  std::mutex mutex;  // guards the writer's lists, summary, progress and error
  std::exception_ptr error;
  std::atomic<int> next{0};
  std::atomic<bool> failed{false};
  const auto take_images = [&] {
    try {
      Synthesizer synthesizer(targets, distractors, options, textures);
      for (int image = next++; image < total && !failed; image = next++) {
        const SyntheticImage made = synthesizer.make(image);
        writer.write_pictures(kSceneId, image, made.frame);
        const std::lock_guard lock(mutex);
        writer.add_entries(kSceneId, image, made.frame, made.instances);
        for (const BopInstance& instance : made.instances) {
          visible[static_cast<std::size_t>(image)] +=
              static_cast<double>(instance.pixels_visible) / instance.pixels_all;
          ++summary.instances;
        }
        ++summary.images;
        if (progress) progress(static_cast<std::size_t>(summary.images), static_cast<std::size_t>(total));
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!error) error = std::current_exception();
      failed = true;
    }
  };
  const auto cores = std::max(1U, std::thread::hardware_concurrency());
  const int count = std::clamp(options.threads > 0 ? options.threads : static_cast<int>(cores), 1, total);
  std::vector<std::thread> others;
  for (int i = 1; i < count; ++i) others.emplace_back(take_images);
  take_images();
  for (std::thread& thread : others) thread.join();
  if (error) std::rethrow_exception(error);

  writer.finish();
  if (summary.instances > 0) {
    summary.mean_visible_fraction = std::accumulate(visible.begin(), visible.end(), 0.0) / summary.instances;
  }
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
