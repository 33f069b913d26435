// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/search_worker.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <limits>
#include <memory>
#include <thread>
#include <utility>

#include "offline/mpi/detect_wire.h"
#include "offline/mpi/frame_wire.h"
#include "runtime/base/error.h"
#include "runtime/model/model_file.h"

namespace sextant {
namespace {

constexpr int kCoordinator = 0;
constexpr std::size_t kNodesPerLook = 32;
constexpr double kStatusInterval = 0.002;  ///< seconds, while there is work
constexpr double kIdleInterval = 0.05;     ///< seconds, without
constexpr double kLongestSilence = 300;    ///< seconds without a word from the coordinator
constexpr double kSoon = 1;                ///< seconds in which the next frame is likely

void rest(int microseconds = 100) { std::this_thread::sleep_for(std::chrono::microseconds(microseconds)); }

class Worker {
 public:
  Worker(int rank, const InjectedFault& fault) : rank_(rank), fault_(fault) {}

  void say_hello() {
    HelloMessage hello;
    hello.process = getpid();
    gethostname(hello.host.data(), hello.host.size() - 1);
    mail_.send_plain(kCoordinator, SearchTag::kHello, hello);
  }

  /// Waits for the next message.
  ReceivedMessage next() {
    const double start = MPI_Wtime();
    while (true) {
      if (auto m = mail_.receive()) return std::move(*m);
      if (MPI_Wtime() - start > kLongestSilence) {
        throw DeviceError("rank " + std::to_string(rank_), "the coordinator is silent",
                          "see rank 0's output");
      }
      rest(MPI_Wtime() - start < kSoon ? 100 : 2000);
    }
  }

  /// One frame's search, until the coordinator says stop.
  std::vector<SearchOutcome> search(const LaneSearchProblem& problem, const FrameShare& share) {
    stamp_ = {share.frame, 0};
    taken_ = expanded_ = 0;
    rate_start_ = MPI_Wtime();
    rate_nodes_ = 0;
    engine_.begin(problem, {share.index, share.count});
    told_.assign(problem.targets.size(), {{}, -std::numeric_limits<double>::infinity()});
    report();
    bool stopped = false;
    while (!stopped) {
      bool any = false;
      while (auto m = mail_.receive()) {
        any = true;
        stopped = handle(*m);
        if (stopped) break;
      }
      if (stopped) break;
      const bool idle = engine_.waiting() == 0;
      if (!idle) {
        engine_.step(kNodesPerLook);
        expanded_ += kNodesPerLook;
        rate_nodes_ += kNodesPerLook;
        maybe_fail();
        tell_bests();
      }
      if (any || (!idle && engine_.waiting() == 0) ||
          MPI_Wtime() - last_report_ > (idle ? kIdleInterval : kStatusInterval)) {
        report();
      }
      if (idle && !any) rest();
    }
    std::vector<SearchOutcome> nothing(problem.targets.size());
    for (SearchOutcome& o : nothing) o.complete = true;
    return nothing;
  }

 private:
  /// True: the search is over.
  bool handle(const ReceivedMessage& m) {
    ByteReader reader(m.bytes);
    switch (m.tag) {
      case SearchTag::kBest: {
        const auto best = reader.take<BestMessage>();
        if (best.stamp.pass == stamp_.pass) engine_.offer(best.target, best.pose);
        return false;
      }
      case SearchTag::kTake:
        reader.take<SearchStamp>();
        engine_.take(reader.rest<LaneNode>());
        ++taken_;
        return false;
      case SearchTag::kGive: {
        const auto give = reader.take<GiveMessage>();
        Bytes bytes;
        append(bytes, stamp_);
        for (const LaneNode& node : engine_.give(give.most)) append(bytes, node);
        mail_.send(kCoordinator, SearchTag::kNodes, std::move(bytes));
        return false;
      }
      case SearchTag::kAdvance:
        stamp_ = reader.take<SearchStamp>();
        engine_.advance(reader.rest<ScoredPose>());
        for (ScoredPose& t : told_) t.score = -std::numeric_limits<double>::infinity();
        tell_bests();
        return false;
      case SearchTag::kStop: {
        Bytes bytes;
        append(bytes, stamp_);
        for (const double highest : engine_.highest_waiting()) append(bytes, highest);
        mail_.send(kCoordinator, SearchTag::kBounds, std::move(bytes));
        engine_.finish(false, {});
        return true;
      }
      case SearchTag::kAlive:
        return false;
      default:
        throw std::logic_error("a worker got a message for somebody else");
    }
  }

  void tell_bests() {
    const std::vector<ScoredPose> bests = engine_.bests();
    for (std::size_t t = 0; t < bests.size(); ++t) {
      if (bests[t].score == -std::numeric_limits<double>::infinity()) continue;
      if (bests[t].score == told_[t].score && bests[t].pose == told_[t].pose) continue;
      told_[t] = bests[t];
      mail_.send_plain(kCoordinator, SearchTag::kBest, BestMessage{stamp_, t, bests[t]});
    }
  }

  void report() {
    const double now = MPI_Wtime();
    StatusMessage status{stamp_, engine_.waiting(), engine_.kept(), taken_, expanded_, 0};
    status.nodes_per_s = static_cast<double>(rate_nodes_) / std::max(now - rate_start_, 1e-6);
    mail_.send_plain(kCoordinator, SearchTag::kStatus, status);
    last_report_ = now;
  }

  void maybe_fail() {
    if (fault_.rank == rank_ && expanded_ >= fault_.nodes) std::raise(fault_.signal);
  }

  int rank_;
  InjectedFault fault_;
  Mailbox mail_;
  LaneSearch engine_;
  SearchStamp stamp_;
  std::vector<ScoredPose> told_;
  std::uint64_t taken_ = 0, expanded_ = 0, rate_nodes_ = 0;
  double rate_start_ = 0, last_report_ = 0;
};

}  // namespace

bool work_for_coordinator(int rank, const InjectedFault& fault) {
  Worker worker(rank, fault);
  worker.say_hello();
  std::uint64_t models = 0;
  DetectOptions options;
  std::vector<ObjectModel> read;
  std::unique_ptr<Detector> detector;
  while (true) {
    const ReceivedMessage m = worker.next();
    ByteReader reader(m.bytes);
    switch (m.tag) {
      case SearchTag::kEnd:
        return reader.take<EndMessage>().together;
      case SearchTag::kSetup:
        models = reader.take<SetupMessage>().models;
        options = take_options(reader);
        options.refine = false;
        options.threads = 1;
        read.clear();
        detector.reset();
        break;
      case SearchTag::kModel:
        read.push_back(decode_model({m.bytes.data(), m.bytes.size()}, "the coordinator's model"));
        if (read.size() == models) detector = std::make_unique<Detector>(std::exchange(read, {}), options);
        break;
      case SearchTag::kFrame: {
        if (!detector) break;
        const auto share = reader.take<FrameShare>();
        DetectCall call = take_call(reader, detector->models());
        const RgbdFrame frame = take_frame(reader);
        call.deadline_ms = 0;
        call.search = [&](const LaneSearchProblem& problem, const DetectCall&) {
          return worker.search(problem, share);
        };
        try {
          detector->detect(frame, call);
        } catch (const DoorError&) {
          // The coordinator refuses the frame in the same words, and where they are read.
        }
        break;
      }
      default:
        break;  // left over from the last frame
    }
  }
}

}  // namespace sextant
