// SPDX-License-Identifier: Apache-2.0
// Does it help to see the next frame (rectification, edges) while the one before is still searched? A camera
// of 30 Hz that plays a data set, newest frame wins, two policies in turns: one after the other, and seen
// ahead, begun so that it is ready when the search ends. Prints rate, age at the end of the search, and
// processor time per frame.
//   sextant-overlap-bench MODEL DATASET [width] [threads] [rounds] [seconds a round]
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "hal/playback/bop_dataset.h"
#include "runtime/base/error.h"
#include "runtime/features/edges.h"
#include "runtime/frame/search_frame.h"
#include "runtime/model/model_file.h"
#include "runtime/search/lanes/lane_search.h"

namespace sextant {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPeriod = std::chrono::nanoseconds(33'333'333);
constexpr double kTolerance = 4 * kLatticeAngle;

double cpu_ms() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}
double ms_between(Clock::time_point a, Clock::time_point b) {
  return std::chrono::duration<double, std::milli>(b - a).count();
}
double median(std::vector<double> v) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

/// A camera whose newest frame can be looked at any time.
class Camera {
 public:
  explicit Camera(const BopDataset& set) {
    for (const BopImage& image : set.images) frames_.push_back(load_frame(image));
  }
  struct Shot {
    const RgbdFrame* frame = nullptr;
    std::int64_t number = -1;
    Clock::time_point captured;
  };
  /// The newest frame; waits for one that is newer than `than`.
  Shot newest(std::int64_t than) const {
    for (;;) {
      const std::int64_t number = (Clock::now() - start_) / kPeriod;
      if (number > than) {
        return {&frames_[static_cast<std::size_t>(number) % frames_.size()], number,
                start_ + number * kPeriod};
      }
      std::this_thread::sleep_until(start_ + (than + 1) * kPeriod);
    }
  }

 private:
  std::vector<RgbdFrame> frames_;
  Clock::time_point start_ = Clock::now();
};

struct Seen {
  Camera::Shot shot;
  SearchFrame rectified;
  cv::Mat edges;
  double ms = 0;
};

struct Result {
  std::vector<double> ages_ms, seen_ms, searched_ms, cycle_ms;
  double cpu_ms = 0, wall_ms = 0;
};

class Bench {
 public:
  Bench(const ObjectModel& model, const BopDataset& set, int width, int threads)
      : model_(model),
        camera_(set),
        rectifier_(width),
        pool_(threads),
        bins_(score_bins(model, Scoring::kLikelihood)),
        threshold_(default_threshold(bins_)) {
    for (const ScoredBin& bin : bins_) {
      lane_bins_.push_back(lane_bin(bin, threshold_));
      radius_ = std::max(radius_, double{bin.largest_visual_radius});
    }
  }

  Result one_after_the_other(double seconds) {
    return measured(seconds, [&](std::int64_t last) { return see(camera_.newest(last)); });
  }

  Result seen_ahead(double seconds) {
    std::mutex mutex;
    std::condition_variable changed;
    std::optional<Seen> ready;
    bool stop = false;
    Clock::time_point begin_at = Clock::now();
    std::thread ahead([&] {
      std::int64_t last = -1;
      for (;;) {
        {
          std::unique_lock lock(mutex);
          changed.wait(lock, [&] { return stop || !ready; });
          while (!stop && Clock::now() < begin_at) changed.wait_until(lock, begin_at);
          if (stop) return;
        }
        Seen seen = see(camera_.newest(last));
        last = seen.shot.number;
        const std::lock_guard lock(mutex);
        ready = std::move(seen);
        changed.notify_all();
      }
    });
    const Result result = measured(seconds, [&](std::int64_t) {
      std::unique_lock lock(mutex);
      changed.wait(lock, [&] { return ready.has_value(); });
      Seen seen = std::move(*ready);
      ready.reset();
      // The next one is to be ready when this search ends.
      begin_at = Clock::now() +
                 std::chrono::microseconds(static_cast<int>(1e3 * std::max(0.0, last_search_ms_ - seen.ms)));
      changed.notify_all();
      return seen;
    });
    {
      const std::lock_guard lock(mutex);
      stop = true;
    }
    changed.notify_all();
    ahead.join();
    return result;
  }

 private:
  Seen see(const Camera::Shot& shot) {
    const auto t = Clock::now();
    Seen seen{shot, rectifier_.rectified(*shot.frame), {}};
    seen.edges = edges_by_direction(seen.rectified.colour);
    seen.ms = ms_between(t, Clock::now());
    return seen;
  }

  void search(const Seen& seen) {
    const Constraint constraint(
        seen.rectified.camera, 0.35, 3.0,
        TableConstraint{
            *seen.shot.frame->table, {TableTolerance{}.height_m, kTolerance}, model_.centre_height_m});
    const double pixels =
        std::ceil(radius_ * seen.rectified.camera.focal / constraint.nearest_feasible_distance()) + 1;
    tables_.build(seen.rectified, seen.edges, static_cast<int>(std::clamp(pixels, 2.0, 200.0)), pool_, false);
    lanes_.build(tables_, pool_);
    LaneSearchProblem problem{tables_, lanes_, {}, {}};
    problem.targets.push_back({bins_, lane_bins_, constraint, model_.bounding_radius_m, 1, threshold_});
    search_.run(problem, pool_);
  }

  template <typename Next>
  Result measured(double seconds, const Next& next) {
    Result result;
    std::int64_t last = -1;
    const auto begin = Clock::now();
    const double cpu = cpu_ms();
    auto before = begin;
    while (ms_between(begin, Clock::now()) < 1e3 * seconds) {
      const Seen seen = next(last);
      last = seen.shot.number;
      const auto t = Clock::now();
      search(seen);
      const auto end = Clock::now();
      last_search_ms_ = ms_between(t, end);
      result.seen_ms.push_back(seen.ms);
      result.searched_ms.push_back(last_search_ms_);
      result.ages_ms.push_back(ms_between(seen.shot.captured, end));
      result.cycle_ms.push_back(ms_between(before, end));
      before = end;
    }
    result.cpu_ms = cpu_ms() - cpu;
    result.wall_ms = ms_between(begin, Clock::now());
    return result;
  }

  const ObjectModel& model_;
  Camera camera_;
  Rectifier rectifier_;
  WorkerPool pool_;
  std::vector<ScoredBin> bins_;
  double threshold_;
  std::vector<LaneBin> lane_bins_;
  double radius_ = 0;
  FrameTables tables_;
  LaneTables lanes_;
  LaneSearch search_;
  double last_search_ms_ = 0;
};

void print(const char* name, const std::vector<Result>& rounds) {
  std::vector<double> rate, age, seen, searched, cpu;
  for (const Result& r : rounds) {
    const auto frames = static_cast<double>(r.ages_ms.size());
    rate.push_back(1e3 * frames / r.wall_ms);
    age.push_back(median(r.ages_ms));
    seen.push_back(median(r.seen_ms));
    searched.push_back(median(r.searched_ms));
    cpu.push_back(r.cpu_ms / frames);
  }
  std::printf(
      "%-22s %5.1f Hz  age %6.1f ms  seeing %5.1f ms  tables and search %6.1f ms  processor %6.1f ms a "
      "frame\n",
      name, median(rate), median(age), median(seen), median(searched), median(cpu));
}

int run(const std::vector<std::string>& arg) {
  const auto number = [&](std::size_t i, int otherwise) {
    return arg.size() > i ? std::stoi(arg[i]) : otherwise;
  };
  const ObjectModel model = read_model(arg[1]);
  const BopDataset set = open_bop_dataset(arg[2], "test");
  Bench bench(model, set, number(3, 0), number(4, 0));
  const int rounds = number(5, 5);
  const double seconds = number(6, 4);
  std::vector<Result> serial, ahead;
  bench.one_after_the_other(1);  // warms up
  for (int i = 0; i < rounds; ++i) {
    serial.push_back(bench.one_after_the_other(seconds));
    ahead.push_back(bench.seen_ahead(seconds));
  }
  print("one after the other:", serial);
  print("seen ahead:", ahead);
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  const std::vector<std::string> arg(argv, argv + argc);
  if (arg.size() < 3) {
    std::fprintf(stderr, "usage: sextant-overlap-bench MODEL DATASET [width] [threads] [rounds] [seconds]\n");
    return 2;
  }
  try {
    return sextant::run(arg);
  } catch (const sextant::DoorError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.exit_code());
  }
}
