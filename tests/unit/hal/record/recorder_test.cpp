// SPDX-License-Identifier: Apache-2.0
// Nothing is lost silently: a slow disk, a full one, and a recorder that is cut off.
#include "hal/record/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <condition_variable>
#include <csignal>
#include <fstream>
#include <mutex>

#include "hal/playback/bop_dataset.h"
#include "hal/playback/frame_reel.h"
#include "hal/playback/playback_source.h"
#include "runtime/base/error.h"
#include "tests/support/small_bop.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

RgbdFrame frame(int i, bool with_table = true) {
  RgbdFrame f;
  f.camera = {.width = 64,
              .height = 48,
              .fx = 61.5,
              .fy = 60.25,
              .cx = 31.1,
              .cy = 23.7,
              .distortion = {0.1, -0.2, 0.001, 0.002, 0.05}};
  f.colour = cv::Mat(48, 64, CV_8UC3, cv::Scalar(i, 10, 20));
  f.axial_depth_m = cv::Mat(48, 64, CV_32FC1, cv::Scalar(0.5 + 0.001 * i));
  f.axial_depth_m.at<float>(0, 0) = 0;
  f.sequence = 1000 + 2 * i;
  f.captured_at = CaptureTime(std::chrono::nanoseconds(1'700'000'000'123'456'789 + 33'000'000LL * i));
  f.captured_monotonic = MonotonicTime(std::chrono::nanoseconds(987'654'321 + 33'000'000LL * i));
  f.frame_id = "camera";
  if (with_table) {
    f.table = TableGeometry::from_pitch_roll(0.6, 0.02, 0.7);
    f.table_uncertainty = TableUncertainty{0.001, 0.002, 0.003, 0.004, 0.005};
  }
  return f;
}

/// A sink whose writes wait for a gate and may fail.
class GatedSink final : public FrameSink {
 public:
  struct Gate {
    std::mutex mutex;
    std::condition_variable changed;
    int open = 0;     ///< writes that may pass; -1: all
    int fail = 0;     ///< writes that fail, from the first
    int entered = 0;  ///< writes that have begun
    std::optional<RecordingEnd> end;

    void let_pass(int writes) {
      const std::lock_guard lock(mutex);
      open = writes;
      changed.notify_all();
    }
    void wait_for_entry(int writes) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return entered >= writes; });
    }
  };
  explicit GatedSink(std::shared_ptr<Gate> gate) : gate_(std::move(gate)) {}
  void write(const RgbdFrame&) override {
    std::unique_lock lock(gate_->mutex);
    ++gate_->entered;
    gate_->changed.notify_all();
    gate_->changed.wait(lock, [&] { return gate_->open != 0; });
    if (gate_->open > 0) --gate_->open;
    if (gate_->fail > 0) {
      --gate_->fail;
      throw DeviceError("disk", "is full", "make space");
    }
  }
  void finish(const RecordingEnd& end) override { gate_->end = end; }

 private:
  std::shared_ptr<Gate> gate_;
};

TEST(Recorder, ASlowDiskLosesFramesCountedAndSaid) {
  auto gate = std::make_shared<GatedSink::Gate>();
  std::vector<std::string> said;
  Recorder recorder(std::make_unique<GatedSink>(gate),
                    {.queue_frames = 3, .say = [&](const std::string& line) { said.push_back(line); }});
  EXPECT_TRUE(recorder.offer(frame(0)));
  gate->wait_for_entry(1);  // one in the disk's hands, three may wait
  for (int i = 1; i <= 3; ++i) EXPECT_TRUE(recorder.offer(frame(i)));
  for (int i = 4; i <= 6; ++i) EXPECT_FALSE(recorder.offer(frame(i)));
  EXPECT_EQ(recorder.statistics().waiting, 3);
  EXPECT_THAT(said, testing::ElementsAre("frame 1008 is lost: the disk does not keep up"));
  gate->let_pass(-1);
  const RecorderStatistics s = recorder.finish(7);
  EXPECT_EQ(s.offered, 7U);
  EXPECT_EQ(s.recorded, 4U);
  EXPECT_EQ(s.lost_slow, 3U);
  EXPECT_EQ(s.offered, s.recorded + s.lost_slow + s.lost_failed);
  ASSERT_TRUE(gate->end);
  EXPECT_EQ(gate->end->lost_slow, 3U);
  EXPECT_EQ(gate->end->lost_source, 7U);
}

TEST(Recorder, FailedWritesAreCountedAndTheRestGoesOn) {
  auto gate = std::make_shared<GatedSink::Gate>();
  gate->open = -1;
  gate->fail = 2;
  std::vector<std::string> said;
  Recorder recorder(
      std::make_unique<GatedSink>(gate),
      {.failures_to_give_up = 3, .say = [&](const std::string& line) { said.push_back(line); }});
  for (int i = 0; i < 5; ++i) recorder.offer(frame(i));
  const RecorderStatistics s = recorder.finish(0);
  EXPECT_EQ(s.recorded, 3U);
  EXPECT_EQ(s.lost_failed, 2U);
  EXPECT_FALSE(recorder.given_up());
  EXPECT_EQ(s.last_failure, "disk: is full; make space");
  EXPECT_THAT(said, testing::ElementsAre("frame 1000 is lost: disk: is full; make space",
                                         "writing works again; 2 frames were lost"));
}

TEST(Recorder, GivesUpOnADiskThatStaysFull) {
  auto gate = std::make_shared<GatedSink::Gate>();
  gate->open = -1;
  gate->fail = 100;
  Recorder recorder(std::make_unique<GatedSink>(gate), {.failures_to_give_up = 3});
  for (int i = 0; i < 4; ++i) recorder.offer(frame(i));
  EXPECT_EQ(recorder.finish(0).lost_failed, 4U);
  EXPECT_TRUE(recorder.given_up());
}

TEST(Recording, PlaysBackWhatWasRecorded) {
  const TemporaryFolder folder;
  auto writer = std::make_unique<RecordingWriter>(RecordingOptions{.folder = folder.path() / "new"});
  Recorder recorder(std::move(writer), {});
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(recorder.offer(frame(i, i != 1)));
  EXPECT_EQ(recorder.finish(0).recorded, 3U);

  PlaybackOptions options;
  options.dataset = folder.path() / "new";
  options.restamp = false;
  const auto source = open_playback(options);
  EXPECT_EQ(source->condition(), "");
  for (int i = 0; i < 3; ++i) {
    const RgbdFrame wanted = frame(i, i != 1);
    const auto got = source->next(std::chrono::seconds(1));
    ASSERT_TRUE(got);
    EXPECT_EQ(cv::norm(got->colour, wanted.colour, cv::NORM_INF), 0);
    EXPECT_LE(cv::norm(got->axial_depth_m, wanted.axial_depth_m, cv::NORM_INF), 0.00005 + 1e-7);
    EXPECT_EQ(got->captured_at, wanted.captured_at);
    EXPECT_EQ(got->captured_monotonic, wanted.captured_monotonic);
    EXPECT_EQ(got->sequence, wanted.sequence);
    EXPECT_EQ(got->frame_id, wanted.frame_id);
    EXPECT_EQ(got->camera.fx, wanted.camera.fx);
    EXPECT_EQ(got->camera.distortion, wanted.camera.distortion);
    ASSERT_EQ(got->table.has_value(), wanted.table.has_value());
    if (!wanted.table) continue;
    EXPECT_NEAR(got->table->pitch_rad(), 0.6, 1e-12);
    EXPECT_EQ(got->table_uncertainty->surface_m, 0.005);
  }
  EXPECT_EQ(source->state(), SourceState::kEnded);
  // The same folder as a BOP data set, lens included.
  const BopDataset bop = open_bop_dataset(options.dataset, "test");
  ASSERT_EQ(bop.images.size(), 3U);
  EXPECT_EQ(load_frame(bop.images[2]).camera.distortion, frame(2).camera.distortion);
  EXPECT_TRUE(bop.images[0].table);
  EXPECT_FALSE(bop.images[1].table);
}

TEST(Recording, ASecondOneIsASecondScene) {
  const TemporaryFolder folder;
  for (int i = 0; i < 2; ++i) {
    Recorder recorder(std::make_unique<RecordingWriter>(RecordingOptions{.folder = folder.path()}), {});
    recorder.offer(frame(i));
    recorder.finish(0);
  }
  const auto reel = open_reel({.dataset = folder.path()});
  ASSERT_EQ(reel->size(), 2U);
  EXPECT_EQ(reel->load(1).scene_id, 2);
}

TEST(Recording, PlaysUpToWhereItWasCutOff) {
  const TemporaryFolder folder;
  {
    RecordingWriter writer({.folder = folder.path()});
    for (int i = 0; i < 3; ++i) writer.write(frame(i));
    // No finish: the machine lost its power.
  }
  auto reel = open_reel({.dataset = folder.path()});
  EXPECT_EQ(reel->size(), 3U);
  EXPECT_THAT(reel->remarks(), testing::ElementsAre("scene 1: the recording was interrupted before its end"));
  const auto list = folder.path() / "test/000001/frames.jsonl";
  std::filesystem::resize_file(list, std::filesystem::file_size(list) - 20);
  reel = open_reel({.dataset = folder.path()});
  EXPECT_EQ(reel->size(), 2U);
  EXPECT_EQ(reel->remarks().size(), 2U);
}

TEST(Recording, DamagedListsAreRefusedWithTheLine) {
  const TemporaryFolder folder;
  {
    RecordingWriter writer({.folder = folder.path()});
    writer.write(frame(0));
    writer.finish({1, 0, 0, 0});
  }
  const auto list = folder.path() / "test/000001/frames.jsonl";
  std::string text;
  {
    std::ifstream in(list);
    text.assign(std::istreambuf_iterator<char>(in), {});
  }
  const auto spoilt = [&](const std::string& from, const std::string& to) -> std::string {
    std::string bad = text;
    bad.replace(bad.find(from), from.size(), to);
    write_text(list, bad);
    try {
      open_reel({.dataset = folder.path()});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(spoilt("\"sextant_recording\":1", "\"sextant_recording\":9"), testing::HasSubstr("version 9"));
  EXPECT_THAT(spoilt("\"width\":64", "\"width\":-3"), testing::HasSubstr("frames.jsonl:2: camera: width"));
  EXPECT_THAT(spoilt("\"fx\":61.5", "\"fx\":1e9"), testing::HasSubstr("fx"));
  EXPECT_THAT(spoilt("\"captured_at_ns\":1", "\"captured_at_ns\":0.1"), testing::HasSubstr("whole number"));
  EXPECT_THAT(spoilt("{\"image\"", "{image"), testing::HasSubstr("frames.jsonl:2: is not valid JSON"));
  EXPECT_THAT(spoilt("\"frame_id\":\"camera\"", "\"frame_id\":7"), testing::HasSubstr("short text"));
  write_text(list, "");
  EXPECT_THROW(open_reel({.dataset = folder.path()}), InputError);
}

TEST(Recording, DepthBeyondTheFileIsCounted) {
  const TemporaryFolder folder;
  RecordingWriter writer({.folder = folder.path()});
  RgbdFrame far = frame(0);
  far.axial_depth_m.setTo(7.5);
  writer.write(far);
  EXPECT_EQ(writer.depth_out_of_range(), 48U * 64U);
  far.axial_depth_m = cv::Mat();
  EXPECT_THROW(writer.write(far), InputError);
}

/// While it lives, no file may grow beyond a size: what a full disk looks like to write().
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_);
    rlimit limit = old_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, old_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

TEST(Recording, AFullDiskLosesTheFrameAndNothingElse) {
  const TemporaryFolder folder;
  Recorder recorder(std::make_unique<RecordingWriter>(RecordingOptions{.folder = folder.path()}), {});
  recorder.offer(frame(0));
  while (recorder.statistics().recorded < 1) std::this_thread::yield();
  {
    const FileSizeLimit full(200);  // less than an image
    recorder.offer(frame(1));
    recorder.offer(frame(2));
    while (recorder.statistics().lost_failed < 2) std::this_thread::yield();
  }
  recorder.offer(frame(3));
  const RecorderStatistics s = recorder.finish(0);
  EXPECT_EQ(s.recorded, 2U);
  EXPECT_EQ(s.lost_failed, 2U);
  const auto reel = open_reel({.dataset = folder.path()});
  ASSERT_EQ(reel->size(), 2U);
  EXPECT_EQ(reel->load(1).sequence, frame(3).sequence);
  EXPECT_THAT(reel->remarks(), testing::ElementsAre("scene 1: 2 frames were lost while it was recorded"));
  // No half images lie about.
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path() / "test/000001/rgb")) {
    files += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(files, 2);
}

TEST(Recording, AFullListKeepsItsWholeLines) {
  const TemporaryFolder folder;
  RecordingWriter writer({.folder = folder.path()});
  // Small images, so that the list is what meets the limit.
  writer.write(frame(0));
  const auto list = folder.path() / "test/000001/frames.jsonl";
  {
    const FileSizeLimit full(std::filesystem::file_size(list) + 100);
    EXPECT_THROW(writer.write(frame(1)), DeviceError);
  }
  writer.write(frame(2));
  writer.finish({2, 0, 1, 0});
  EXPECT_EQ(open_reel({.dataset = folder.path()})->size(), 2U);
}

TEST(Recording, AFolderThatCannotBeMadeIsSaid) {
  const TemporaryFolder folder;
  write_text(folder.path() / "file", "x");
  EXPECT_THROW(RecordingWriter({.folder = folder.path() / "file"}), InputError);
  EXPECT_THROW(RecordingWriter({.folder = folder.path(), .depth_scale_mm = 0}), UsageError);
}

}  // namespace
}  // namespace sextant
