// SPDX-License-Identifier: Apache-2.0
// sextant render: one synthetic RGB-D view of a mesh.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "hal/image/image_file.h"
#include "offline/cli/commands.h"
#include "offline/cli/mesh_options.h"
#include "offline/render/renderer.h"
#include "runtime/base/error.h"
#include "runtime/geometry/pose_mapping.h"

namespace sextant {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

struct Arguments {
  std::filesystem::path mesh;
  MeshArguments mesh_arguments;
  std::string pose;
  std::filesystem::path output;
  std::filesystem::path depth_output;
  int width = 640;
  int height = 480;
  double focal = 525;
  double ambient = 0.5;
};

/// "X,Y,Z,RX,RY,RZ": pixels, metres, degrees.
Pose6 parse_pose(const std::string& text) {
  Pose6 p;
  int used = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf%n", &p.x, &p.y, &p.z, &p.rx, &p.ry, &p.rz, &used) !=
          6 ||
      static_cast<std::size_t>(used) != text.size()) {
    throw UsageError("--pose " + text + " is not X,Y,Z,RX,RY,RZ (pixels, metres, degrees)",
                     "for example 320,240,0.8,0,-40,30");
  }
  if (!(p.z > 0.01 && p.z < 100)) throw UsageError("--pose: the distance must be 0.01..100 m");
  p.rx *= kDegree;
  p.ry *= kDegree;
  p.rz *= kDegree;
  return p;
}

void run(const Arguments& a) {
  const Pose6 pose = parse_pose(a.pose);
  const StandingObject object = load_standing_object(a.mesh, a.mesh_arguments.options());
  const PinholeCamera camera{a.width, a.height, a.focal, (a.width - 1) / 2.0, (a.height - 1) / 2.0};
  Renderer renderer;
  Light light;
  light.ambient = a.ambient;
  light.position_in_camera = {-0.7, -1.2, -0.3};
  const RenderedView view = renderer.render(
      camera, {0, 0, a.width, a.height}, {{renderer.upload(object.mesh), transform_from_pose(camera, pose)}},
      light, {70, 74, 80});
  write_png(a.output, view.colour);
  if (!a.depth_output.empty()) {
    cv::Mat axial_mm10(a.height, a.width, CV_16UC1);
    for (int y = 0; y < a.height; ++y) {
      for (int x = 0; x < a.width; ++x) {
        const double axial_m = view.ray_depth_m.at<float>(y, x) * camera.ray(x, y).z();
        axial_mm10.at<std::uint16_t>(y, x) = cv::saturate_cast<std::uint16_t>(axial_m * 1e4);
      }
    }
    write_png(a.depth_output, axial_mm10);
  }
  fmt::print("{}\n", a.output.string());
}

}  // namespace

CLI::App* add_render_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  Arguments& a = *arguments;
  CLI::App* command = app.add_subcommand("render", "one synthetic RGB-D view of a mesh");
  command->footer("Example:\n  sextant render mug.stl --units mm --pose 320,240,0.5,0,-40,30 -o mug.png");
  command->add_option("mesh", a.mesh, "PLY, OBJ, STL, glTF/GLB or DAE file")->required();
  a.mesh_arguments.add_to(*command);
  command->add_option("--pose", a.pose, "X,Y,Z,RX,RY,RZ: pixels, metres of ray distance, degrees")
      ->required();
  command->add_option("-o,--output", a.output, "colour PNG to write")->required();
  command->add_option("--depth", a.depth_output, "16-bit depth PNG to write, 0.1 mm along the optical axis");
  command->add_option("--width", a.width, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  command->add_option("--height", a.height, "pixels")->check(CLI::Range(16, 8192))->capture_default_str();
  command->add_option("--focal", a.focal, "pixels")->check(CLI::Range(10.0, 20000.0))->capture_default_str();
  command->add_option("--ambient", a.ambient, "share of ambient light")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->callback([arguments, &exit_code] {
    run(*arguments);
    exit_code = static_cast<int>(ExitCode::kDone);
  });
  return command;
}

}  // namespace sextant
