// SPDX-License-Identifier: Apache-2.0
// sextant tune: the thesis's parameter experiment (section 6.2) as one command.
#include "offline/cli/tune_command.h"

#include <memory>

#include "offline/cli/progress_bar.h"
#include "offline/cli/tune_options.h"
#include "runtime/base/error.h"

namespace sextant {

CLI::App* add_tune_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<TuneArguments>();
  CLI::App* command =
      app.add_subcommand("tune", "sweep parameters on a training half, report on the held-out half");
  command->footer(
      "Example:\n  sextant tune mug.stl --units mm --dataset labelled -o tuning --sweep "
      "visual_radius_px=4,6,8,10 "
      "--sweep depth_parts=0,50,150\n  sextant compile mug.stl --units mm --params tuning/tuned.yaml -o "
      "mug.sxm");
  arguments->add_to(*command);
  command->callback([arguments, &exit_code] {
    PreparedTuning tuning = prepare_tuning(*arguments);
    TuneResult result;
    {
      ProgressBar bar("points");
      tuning.run.progress = [&](std::size_t done, std::size_t total) { bar.show(done, total); };
      result = finish_run(tuning.run, tuning.trial);
    }
    report_tuning(*arguments, tuning, result);
    exit_code = static_cast<int>(ExitCode::kDone);
  });
  return command;
}

}  // namespace sextant
