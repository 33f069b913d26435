// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/compile.h"

#include <algorithm>
#include <filesystem>
#include <thread>

#include "offline/learn/bin_codec.h"
#include "offline/learn/learn_bin.h"
#include "offline/learn/surface_marks.h"
#include "offline/learn/training_view.h"
#include "offline/learn/worker_processes.h"
#include "offline/mesh/simplify.h"
#include "offline/render/renderer.h"
#include "runtime/base/error.h"
#include "runtime/base/version.h"

namespace sextant {
namespace {

constexpr std::size_t kModelTriangles = 4000;
constexpr double kMeshToleranceM = 0.0005;  // half a sensor's step of depth

/// Seed of one bin (splitmix64 of the job's seed and the bin's number).
std::uint64_t seed_of_bin(std::uint64_t seed, std::size_t bin) {
  std::uint64_t v = seed * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(bin) + 1;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9ULL;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBULL;
  return v ^ (v >> 31);
}

/// What one worker renders with.
struct Studio {
  Renderer renderer;
  Scenery scenery{renderer};
  int mesh;
  explicit Studio(const StandingObject& object) : mesh(renderer.upload(object.mesh)) {}
};

/// Half of the scenes show the object as claimed; the others share what else may be there.
SceneTruth truth_of_scene(int index, bool has_sides) {
  if (index % 2 == 0) return SceneTruth::kObject;
  return index % 4 == 1 || !has_sides ? SceneTruth::kClutter : SceneTruth::kTurnedObject;
}

ViewpointBin learn_one(Studio& studio, const StandingObject& object, const LearnParameters& p,
                       const RotationBox& box, std::uint64_t seed) {
  RotationBox viewed = box;
  const bool has_sides = box.hi_deg[2] - box.lo_deg[2] > 1;
  if (!has_sides) viewed.hi_deg[2] = 360;  // a round object may show any side
  TrainingViews source(studio.renderer, studio.scenery, studio.mesh, object.bounding_radius_m,
                       object.centre_height_m, p, viewed, seed);
  std::vector<TrainingView> views;
  for (int i = 0; i < p.images_per_bin; ++i) views.push_back(source.next());
  SceneViews tests(studio.renderer, studio.scenery, studio.mesh, object.bounding_radius_m,
                   object.centre_height_m, object.symmetry_deg, p, box, derived_seed(seed, 1));
  std::vector<TestScene> scenes;
  for (int i = 0; i < p.scenes_per_bin; ++i) {
    const SceneTruth truth = truth_of_scene(i, has_sides);
    scenes.push_back({truth, tests.next(truth)});
  }
  return learn_bin(views, scenes, p, box, object.bounding_radius_m);
}

}  // namespace

std::vector<ViewpointBin> learn_bins(const StandingObject& object, const LearnParameters& parameters,
                                     const std::vector<RotationBox>& boxes, int threads, std::size_t first,
                                     std::size_t stride, const Progress& progress) {
  std::vector<ViewpointBin> bins(boxes.size());
  const std::size_t total = boxes.size() > first ? (boxes.size() - first + stride - 1) / stride : 0;
  std::size_t done = 0;
  const auto keep = [&](std::size_t bin, ViewpointBin learnt) {
    bins.at(bin) = std::move(learnt);
    if (progress) progress(++done, total);
  };
  // Worker w of n learns every nth of the bins asked for.
  const auto learn_share = [&](std::size_t worker, std::size_t workers, const auto& give) {
    Studio studio(object);
    for (std::size_t i = worker; i < total; i += workers) {
      const std::size_t bin = first + i * stride;
      give(bin, learn_one(studio, object, parameters, boxes[bin], seed_of_bin(parameters.seed, bin)));
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const auto workers = std::min<std::size_t>(threads > 0 ? static_cast<std::size_t>(threads) : cores, total);
  if (workers <= 1) {
    learn_share(0, 1, keep);
    return bins;
  }
  run_worker_processes(
      static_cast<int>(workers),
      [&](int worker, const Deliver& deliver) {
        learn_share(static_cast<std::size_t>(worker), workers,
                    [&](std::size_t bin, const ViewpointBin& learnt) { deliver(bin, encode_bin(learnt)); });
      },
      [&](std::size_t bin, std::span<const std::byte> bytes) { keep(bin, decode_bin(bytes)); });
  return bins;
}

ObjectModel assemble_model(const StandingObject& object, const LearnParameters& parameters,
                           std::vector<ViewpointBin> bins, const std::string& mesh_file_name, int object_id) {
  for (const ViewpointBin& bin : bins) {
    if (bin.visual.empty() && bin.depth.empty()) {
      throw InputError(mesh_file_name, "a view of the mesh shows nothing that could be learnt",
                       "check the mesh with sextant render");
    }
  }
  ObjectModel model;
  model.name = std::filesystem::path(mesh_file_name).stem().string();
  model.object_id = object_id;
  model.symmetry_deg = object.symmetry_deg;
  model.geometric_symmetry_deg = object.geometric_symmetry_deg;
  model.bounding_radius_m = object.bounding_radius_m;
  model.centre_height_m = object.centre_height_m;
  model.object_from_mesh = object.object_from_mesh;
  model.bins = std::move(bins);
  model.mesh = simplified_within(object.mesh, kMeshToleranceM, kModelTriangles);
  {
    Renderer renderer;
    const int mesh = renderer.upload(object.mesh);
    model.marks = find_surface_marks(renderer, mesh, object, model.mesh);
  }
  model.provenance.program_version = kProgramVersion;
  model.provenance.mesh_name = mesh_file_name;
  model.provenance.mesh_hash = object.file_hash;
  model.provenance.seed = parameters.seed;
  model.provenance.parameters = parameters.to_yaml();
  return model;
}

}  // namespace sextant
