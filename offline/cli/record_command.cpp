// SPDX-License-Identifier: Apache-2.0
// sextant record: frames of any source onto the disk, none lost without being counted and said.
#include <fmt/format.h>
#include <sys/statvfs.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "hal/record/recorder.h"
#include "hal/table/table_locator.h"
#include "offline/cli/commands.h"
#include "offline/cli/progress_bar.h"
#include "offline/cli/source_arguments.h"
#include "offline/cli/stop_on_signal.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;

struct Arguments {
  SourceArguments source;
  RecordingOptions recording;
  std::uint64_t frames = 0;
  double seconds = 0;
  int queue_frames = 30;
  std::string table = "file";
  bool json = false;
  bool require = false;
};

void say(const std::string& line) { fmt::print(stderr, "sextant record: {}\n", line); }

void warn_of_little_space(const std::filesystem::path& folder) {
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) != 0) return;
  const double gigabytes = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize) / 1e9;
  // About 1 MB a frame at 640 x 480.
  if (gigabytes < 2)
    say(fmt::format("only {:.1f} GB are free: about {:.0f} s at 30 Hz", gigabytes, gigabytes * 33));
}

/// Every frame until the end that was asked for. Returns the source's own losses.
SourceStatistics run_frames(FrameSource& source, Recorder& recorder, TableLocator* table,
                            const Arguments& a) {
  const StopOnSignal stop;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(a.seconds > 0 ? a.seconds : 1e8));
  ProgressBar bar("frames");
  std::uint64_t taken = 0;
  std::string condition;
  std::string table_problem;
  const bool live = a.source.source.kind != "playback";
  while (!stop.requested() && Clock::now() < end && (a.frames == 0 || taken < a.frames) &&
         !recorder.given_up()) {
    std::optional<RgbdFrame> frame;
    try {
      frame = source.next(std::chrono::milliseconds(100));
    } catch (const InputError& error) {
      say(error.what());  // counted by the source
      continue;
    }
    if (source.condition() != condition) {
      condition = source.condition();
      if (!condition.empty()) say(condition);
    }
    if (!frame) {
      if (source.state() == SourceState::kEnded) break;
      continue;
    }
    if (table) {
      try {
        table->locate(*frame);
        table_problem.clear();
      } catch (const InputError& error) {
        if (table_problem != error.what()) say(std::string("recorded without a table: ") + error.what());
        table_problem = error.what();
        frame->table.reset();
        frame->table_uncertainty.reset();
      }
    }
    // A recording can wait for the disk, a camera cannot.
    while (!live && recorder.statistics().waiting >= a.queue_frames && !recorder.given_up()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    recorder.offer(std::move(*frame));
    ++taken;
    if (a.frames > 0) bar.show(taken, a.frames);
  }
  const SourceStatistics statistics = source.statistics();
  source.close();
  return statistics;
}

int run(const Arguments& a) {
  SourceOptions options = a.source.options();
  options.playback.restamp = false;
  options.rectify = false;  // recorded as the camera saw it: the search rectifies
  const std::unique_ptr<FrameSource> source = open_source(options);
  std::unique_ptr<TableLocator> table;
  if (a.table == "estimate") {
    table = std::make_unique<TableLocator>(TableLocatorOptions{});
  } else if (a.table != "file") {
    throw UsageError("--table " + a.table + " is not file or estimate");
  }
  auto writer = std::make_unique<RecordingWriter>(a.recording);
  const RecordingWriter& written = *writer;
  const std::filesystem::path scene = writer->scene_folder();
  warn_of_little_space(scene);
  Recorder recorder(std::move(writer), {.queue_frames = a.queue_frames, .say = say});
  const SourceStatistics of_source = run_frames(*source, recorder, table.get(), a);
  const bool given_up = recorder.given_up();
  const RecorderStatistics s = recorder.finish(of_source.dropped());
  const std::uint64_t lost = s.lost_slow + s.lost_failed + of_source.dropped();
  if (a.json) {
    fmt::print("{}\n", nlohmann::ordered_json{{"folder", scene.string()},
                                              {"recorded", s.recorded},
                                              {"lost_slow", s.lost_slow},
                                              {"lost_failed", s.lost_failed},
                                              {"lost_source", of_source.dropped()},
                                              {"lost_source_reasons", describe_drops(of_source)},
                                              {"bytes", written.bytes_written()},
                                              {"depth_out_of_range", written.depth_out_of_range()}}
                           .dump());
  } else {
    fmt::print("{}: {} frames, {:.1f} MB; lost: {} (slow disk), {} (failed writes), {} by the source ({})\n",
               scene.string(), s.recorded, static_cast<double>(written.bytes_written()) / 1e6, s.lost_slow,
               s.lost_failed, of_source.dropped(), describe_drops(of_source));
    if (written.depth_out_of_range() > 0) {
      fmt::print("{} depth pixels were too far for {} mm in 16 bits and are missing; see --depth-scale-mm\n",
                 written.depth_out_of_range(), a.recording.depth_scale_mm);
    }
  }
  if (given_up || (s.recorded == 0 && s.lost_failed > 0)) {
    throw DeviceError(scene.string(), "writing failed: " + s.last_failure);
  }
  if (s.recorded == 0) throw DeviceError(a.source.describe(), "no frame came", source->condition());
  return static_cast<int>(a.require && lost > 0 ? ExitCode::kNothingFound : ExitCode::kDone);
}

}  // namespace

CLI::App* add_record_command(CLI::App& app, int& exit_code) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("record", "record frames of a source as a data set that plays back");
  command->footer(
      "Examples:\n"
      "  sextant record -o out --source dds --color-topic camera/color/image_raw \\\n"
      "    --depth-topic camera/aligned_depth_to_color/image_raw --seconds 10 --table estimate\n"
      "  sextant record -o out --dataset rgbd_dataset_freiburg1_desk\n"
      "Every recording is a new scene of the folder. Ctrl-C ends it cleanly.");
  command->add_option("-o,--output", a->recording.folder, "folder of the data set")->required();
  a->source.add_to(*command);
  command->add_option("--frames", a->frames, "end after so many");
  command->add_option("--seconds", a->seconds, "end after so long")->check(CLI::NonNegativeNumber);
  command->add_option("--table", a->table, "file: as the source says | estimate: from the depth image")
      ->capture_default_str();
  command->add_option("--depth-scale-mm", a->recording.depth_scale_mm, "of the 16-bit depth files")
      ->capture_default_str();
  command->add_option("--png-compression", a->recording.png_compression, "0 (fast, large) to 9")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  command->add_option("--queue-frames", a->queue_frames, "that may wait for the disk")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--json", a->json, "the result as one JSON object");
  command->add_flag("--require", a->require, "exit 1 where a frame was lost");
  command->callback([a, &exit_code] { exit_code = run(*a); });
  return command;
}

}  // namespace sextant
