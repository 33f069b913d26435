// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/evaluate_command.h"

#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <optional>

#include "hal/image/file_bytes.h"
#include "hal/image/image_file.h"
#include "offline/cli/progress_bar.h"
#include "offline/evaluate/point_error.h"
#include "offline/evaluate/report_text.h"
#include "offline/evaluate/vsd_evaluation.h"
#include "offline/mesh/mesh_reader.h"
#include "offline/report/html/worst_cases.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

constexpr std::size_t kMeshPoints = 1500;  ///< ADD-S compares all pairs
constexpr double kMetresPerMm = 0.001;

struct Arguments {
  std::filesystem::path dataset;
  std::filesystem::path csv;
  std::filesystem::path report;
  std::string split = "test";
  int scene = -1;
  std::vector<int> objects;
  std::vector<std::string> symmetries;  ///< ID=DEG
  std::vector<std::string> ups;         ///< ID=AXIS
  bool geometric = false;
  bool json = false;
  bool no_vsd = false;
  std::size_t pictures = 24;
  std::optional<double> require;
  EvaluationOptions options;
};

/// "ID=VALUE".
std::pair<int, std::string> parse_assignment(const std::string& text, const char* option) {
  const std::size_t equals = text.find('=');
  int id = -1;
  const char* end = text.data() + std::min(equals, text.size());
  const auto [stop, error] = std::from_chars(text.data(), end, id);
  if (equals == std::string::npos || error != std::errc() || stop != end || id < 0) {
    throw UsageError(fmt::format("{} {} is not ID=VALUE", option, text),
                     fmt::format("for example {} 5=180", option));
  }
  return {id, text.substr(equals + 1)};
}

Eigen::Vector3d parse_axis(const std::string& text) {
  const bool minus = !text.empty() && text[0] == '-';
  const std::size_t axis = std::string("xyz").find(text.substr(minus ? 1 : 0));
  if (text.size() != (minus ? 2U : 1U) || axis == std::string::npos) {
    throw UsageError("--up: " + text + " is no axis", "give x, y, z, -x, -y or -z");
  }
  return (minus ? -1.0 : 1.0) * Eigen::Vector3d::Unit(static_cast<int>(axis));
}

/// The mesh of an object of the data set, metres; nothing where there is none.
std::optional<Mesh> load_mesh(const Arguments& a, int id) {
  const std::filesystem::path file = a.dataset / "models" / fmt::format("obj_{:06}.ply", id);
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  return read_mesh(file, kMetresPerMm);
}

ModelMesh bare_mesh(const Mesh& mesh) {
  ModelMesh bare;
  bare.vertices = mesh.vertices;
  for (const MeshPart& part : mesh.parts)
    bare.triangles.insert(bare.triangles.end(), part.triangles.begin(), part.triangles.end());
  return bare;
}

EvaluatedObject load_object(const Arguments& a, int id, const ModelsInfo& infos,
                            const std::optional<Mesh>& mesh) {
  ModelInfo info;
  if (const auto it = infos.find(id); it != infos.end()) info = it->second;
  EvaluatedObject object;
  for (const std::string& text : a.ups) {
    if (const auto [up_id, axis] = parse_assignment(text, "--up"); up_id == id) info.up = parse_axis(axis);
  }
  object.symmetry = symmetry_group_of(info, a.geometric);
  for (const std::string& text : a.symmetries) {
    const auto [symmetry_id, value] = parse_assignment(text, "--symmetry");
    if (value != "0" && value != "90" && value != "180" && value != "360") {
      throw UsageError("--symmetry " + text + ": the angle must be 0 (any), 90, 180 or 360");
    }
    if (symmetry_id == id)
      object.symmetry = SymmetryGroup::about(info.up.value_or(Eigen::Vector3d::UnitZ()), std::stoi(value));
  }
  object.up = info.up.value_or(Eigen::Vector3d::UnitZ());
  object.centre_m = info.centre_m();
  object.diameter_m = info.diameter_m;
  if (mesh) object.points = thinned(mesh->vertices, kMeshPoints);
  return object;
}

/// Pixels of a row; 640 where the image is not there (results can be judged without pictures).
int image_width_of(const BopImage& image) {
  std::error_code error;
  if (!std::filesystem::exists(image.colour, error)) return 640;
  return read_colour_image(image.colour).cols;
}

/// All that the command works on.
struct Work {
  BopDataset dataset;
  std::map<int, Mesh> meshes;
  EvaluationReport report;
};

/// VSD where it can be measured; a line on stderr where not.
void measure_vsd(Work& work, const BopDataset& dataset, const std::map<int, EvaluatedObject>& objects) {
  std::error_code error;
  for (const BopImage& image : dataset.images) {
    if (std::filesystem::exists(image.depth, error)) continue;
    fmt::print(stderr, "sextant: {} is missing: VSD and BOP's average recall are left out\n",
               image.depth.string());
    return;
  }
  try {
    ProgressBar progress("VSD");
    add_vsd(work.report, dataset.images, objects, work.meshes,
            [&](std::size_t done, std::size_t total) { progress.show(done, total); });
  } catch (const DeviceError& e) {
    fmt::print(stderr, "sextant: {}: VSD and BOP's average recall are left out\n", e.what());
  }
}

Work evaluate_files(const Arguments& a) {
  BopDataset dataset = open_bop_dataset(a.dataset, a.split, a.scene);
  if (!dataset.has_ground_truth) {
    throw InputError((a.dataset / a.split).string(), "has no ground truth", "scene_gt.json is missing");
  }
  std::vector<BopResult> results = read_bop_results(a.csv);
  if (a.scene >= 0) std::erase_if(results, [&](const BopResult& r) { return r.scene_id != a.scene; });
  std::set<int> ids(a.objects.begin(), a.objects.end());
  if (ids.empty()) {
    for (const BopResult& result : results) ids.insert(result.object_id);
  }
  if (ids.empty()) throw InputError(a.csv.string(), "holds no result", "name the objects with --objects");
  const std::filesystem::path info_file = a.dataset / "models" / "models_info.json";
  std::error_code error;
  const ModelsInfo infos =
      std::filesystem::exists(info_file, error) ? read_models_info(info_file) : ModelsInfo{};
  Work work;
  std::map<int, EvaluatedObject> objects;
  for (const int id : ids) {
    const std::optional<Mesh> mesh = load_mesh(a, id);
    objects[id] = load_object(a, id, infos, mesh);
    if (mesh) work.meshes[id] = *mesh;
  }
  EvaluationOptions options = a.options;
  if (!dataset.images.empty()) options.image_width = image_width_of(dataset.images.front());
  work.report = evaluate(dataset.images, results, objects, options, a.csv.string());
  if (!a.no_vsd && !work.meshes.empty()) measure_vsd(work, dataset, objects);
  work.dataset = std::move(dataset);
  return work;
}

int run(const Arguments& a) {
  const Work work = evaluate_files(a);
  const EvaluationReport& report = work.report;
  if (!a.report.empty()) {
    std::map<int, ModelMesh> meshes;
    for (const auto& [id, mesh] : work.meshes) meshes[id] = bare_mesh(mesh);
    const std::string html =
        format_report_html(report, "Accuracy of " + a.csv.filename().string(),
                           worst_case_pictures(report, work.dataset.images, meshes, a.pictures));
    write_file_bytes(a.report, std::as_bytes(std::span(html)));
  }
  if (a.json) {
    fmt::print("{}\n", format_report_json(report));
  } else {
    fmt::print("{}", format_report_text(report));
    if (!a.report.empty()) fmt::print("report written to {}\n", a.report.string());
  }
  const bool enough = !a.require || report.total.share_right() >= *a.require;
  return static_cast<int>(enough ? ExitCode::kDone : ExitCode::kNothingFound);
}

}  // namespace

CLI::App* add_evaluate_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  CLI::App* command =
      app.add_subcommand("evaluate", "Accuracy of a results CSV against a data set's ground truth");
  command->add_option("--dataset", a.dataset, "BOP data set")->required()->type_name("DIR");
  command->add_option("--csv", a.csv, "Results (scene_id,im_id,obj_id,score,R,t,time)")
      ->required()
      ->type_name("FILE");
  command->add_option("--report", a.report, "HTML page to write")->type_name("FILE.html");
  command->add_option("--pictures", a.pictures, "Pictures of the worst cases in the report, at most")
      ->check(CLI::Range(0, 500))
      ->capture_default_str();
  command->add_flag("--no-vsd", a.no_vsd,
                    "Leave VSD (which renders every pose) and BOP's average recall out");
  command->add_option("--split", a.split, "Folder of the data set")->capture_default_str();
  command->add_option("--scene", a.scene, "This scene only")->check(CLI::NonNegativeNumber);
  command->add_option("--objects", a.objects, "Object ids to evaluate, e.g. 1,5 (default: those in the CSV)")
      ->delimiter(',');
  command->add_option("--max-translation-cm", a.options.max_translation_cm, "A right pose is within this")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--max-rotation-deg", a.options.max_rotation_deg, "and within this")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command
      ->add_option("--strict-translation-cm", a.options.strict_translation_cm,
                   "A strictly right pose is within this")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--strict-rotation-deg", a.options.strict_rotation_deg, "and within this")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command->add_option("--min-visible", a.options.min_visible, "Ignore objects of which less is seen")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_flag("--upright", a.options.upright_only, "Ignore objects that do not stand on the table");
  command->add_flag("--geometric", a.geometric, "Symmetry of the shape alone, not of the print");
  command
      ->add_option("--symmetry", a.symmetries,
                   "ID=DEG: rotations about the object's up that do not count (0: any)")
      ->type_name("ID=DEG")
      ->expected(1, 1000);
  command
      ->add_option("--up", a.ups,
                   "ID=AXIS: what points up when the object stands (default: models_info.json, else z)")
      ->type_name("ID=AXIS")
      ->expected(1, 1000);
  command->add_option("--require", a.require, "Exit 1 unless this share of the objects is right")
      ->check(CLI::Range(0.0, 1.0));
  command->add_flag("--json", a.json, "Print one JSON object");
  command->footer("Example: sextant evaluate --dataset sample --csv results.csv --report accuracy.html");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
  return command;
}

}  // namespace sextant
