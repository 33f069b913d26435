// SPDX-License-Identifier: Apache-2.0
#include "offline/cli/inspect_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "hal/image/image_file.h"
#include "offline/cli/model_summary.h"
#include "offline/report/model_sheet/contact_sheet.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

struct InspectArguments {
  std::filesystem::path model;
  std::filesystem::path picture;
  std::size_t bins = 24;
  bool json = false;
};

void inspect(const InspectArguments& arguments) {
  const ModelFileContent content = read_model_file(arguments.model);
  // The picture first: where it cannot be written, nothing is printed.
  if (!arguments.picture.empty()) {
    ContactSheetOptions options;
    options.max_bins = arguments.bins;
    write_png(arguments.picture, draw_contact_sheet(content.model, options));
  }
  if (arguments.json) {
    fmt::print("{}\n", model_as_json(content, arguments.model.string()));
  } else {
    fmt::print("{}", model_as_text(content, arguments.model.string(), arguments.bins));
    if (!arguments.picture.empty()) fmt::print("picture written to {}\n", arguments.picture.string());
  }
}

}  // namespace

CLI::App* add_inspect_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<InspectArguments>();
  CLI::App* command = app.add_subcommand(
      "inspect", "Print what a compiled model holds and where it came from; draw its viewpoint bins");
  command->add_option("model", arguments->model, "Compiled model (*.sxtm)")->required()->type_name("MODEL");
  command->add_option("--picture", arguments->picture, "Write a contact sheet of bins with their parts")
      ->type_name("FILE.png");
  command
      ->add_option(
          "--bins", arguments->bins,
          "Bins to list and to draw, evenly spread over the model's, 1.." + std::to_string(kMaxSheetBins))
      ->check(CLI::Range(std::size_t{1}, kMaxSheetBins))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print one JSON object with all bins");
  command->footer("Example: sextant inspect mug.sxtm --picture mug.png");
  command->callback([arguments, &exit_code] {
    inspect(*arguments);
    exit_code = 0;
  });
  return command;
}

}  // namespace sextant
