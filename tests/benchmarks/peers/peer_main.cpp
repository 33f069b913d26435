// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <charconv>
#include <chrono>
#include <cstdio>

#include "hal/playback/bop_dataset.h"
#include "offline/cli/object_file.h"
#include "offline/dataset/bop_results.h"
#include "runtime/base/error.h"
#include "tests/benchmarks/peers/peer.h"

namespace sextant {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

PeerObject load(const std::string& text, Renderer& renderer) {
  PeerObject result;
  const std::size_t equals = text.find('=');
  const char* end = text.data() + std::min(equals, text.size());
  const auto [stop, error] = std::from_chars(text.data(), end, result.id);
  if (equals == std::string::npos || error != std::errc() || stop != end)
    throw UsageError("--object " + text + " is not ID=MESH[@UNITS[,UP]]");
  result.object = load_object_file(text.substr(equals + 1), MeshArguments{}).object;
  result.mesh = renderer.upload(result.object.mesh);
  return result;
}

}  // namespace

int run_peer(int argc, char** argv, const std::string& name, Peer& peer) {
  CLI::App app("Results of " + name + " on a BOP data set with tables", "sextant-peer-" + name);
  std::vector<std::string> texts;
  std::filesystem::path dataset;
  std::filesystem::path csv;
  PeerRanges ranges;
  app.add_option("--object", texts, "ID=MESH[@UNITS[,UP]]")->required()->expected(1, 100);
  app.add_option("--dataset", dataset)->required();
  app.add_option("--csv", csv, "BOP results to write")->required();
  app.add_option("--min-pitch-deg", ranges.min_pitch_deg)->capture_default_str();
  app.add_option("--max-pitch-deg", ranges.max_pitch_deg)->capture_default_str();
  app.add_option("--min-distance-m", ranges.min_distance_m)->capture_default_str();
  app.add_option("--max-distance-m", ranges.max_distance_m)->capture_default_str();
  try {
    app.parse(argc, argv);
    const BopDataset set = open_bop_dataset(dataset, "test");
    Renderer renderer;
    std::vector<PeerObject> objects;
    for (const std::string& text : texts) objects.push_back(load(text, renderer));
    RgbdFrame first = load_frame(set.images.front());
    const auto learning = std::chrono::steady_clock::now();
    for (const PeerObject& object : objects) peer.learn(object, first.camera.ideal(), ranges, renderer);
    std::printf("%s: learnt %zu objects in %.1f s\n", name.c_str(), objects.size(), seconds_since(learning));
    std::vector<BopResult> rows;
    double total = 0;
    for (const BopImage& image : set.images) {
      const RgbdFrame frame = load_frame(image);
      if (!frame.table) continue;
      const PinholeCamera camera = frame.camera.ideal();
      const auto start = std::chrono::steady_clock::now();
      std::vector<BopResult> found;
      for (const PeerObject& object : objects) {
        const auto answer = peer.find(object, frame, camera, renderer);
        if (!answer) continue;
        BopResult row;
        row.scene_id = image.scene_id;
        row.image_id = image.image_id;
        row.object_id = object.id;
        row.score = answer->score;
        row.camera_from_mesh = answer->camera_from_object * object.object.object_from_mesh;
        found.push_back(row);
      }
      const double seconds = seconds_since(start);
      total += seconds;
      for (BopResult& row : found) {
        row.seconds = seconds;
        rows.push_back(row);
      }
    }
    write_bop_results(csv, rows);
    std::printf("%s: %.3f s per image and object\n", name.c_str(),
                total / static_cast<double>(set.images.size() * objects.size()));
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const DoorError& e) {
    std::fprintf(stderr, "sextant-peer-%s: %s\n", name.c_str(), e.what());
    return static_cast<int>(e.exit_code());
  }
  return 0;
}

}  // namespace sextant
