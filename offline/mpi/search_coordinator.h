// SPDX-License-Identifier: Apache-2.0
// The coordinator of a distributed search (COORDINATOR, Davies 2015, Proc. 31), which also searches itself:
// it collects status and best poses, broadcasts the best, moves the top of a queue to an idle rank in
// proportion to the two measured rates, and ends passes. Beyond the thesis, a rank that dies or stalls loses
// nothing: everything it was given (its share of the roots, and the nodes moved to it) is kept until it says
// that it has nothing left, and searched again by the others.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "offline/mpi/search_wire.h"
#include "runtime/detect/detector.h"

namespace sextant {

struct CoordinatorOptions {
  double lost_after_s = 30;  ///< of silence; a rank of this machine that died is noticed at once
  bool verbose = false;      ///< says on stderr what was moved and which ranks were lost
};

class SearchCoordinator {
 public:
  /// Waits for every rank's first word. Throws DeviceError where one does not speak within a minute.
  SearchCoordinator(int ranks, const CoordinatorOptions& options);
  /// What the frames to come are searched for and how, for all workers.
  void send_setup(const Detector& detector);
  /// The next frame: all workers prepare it and wait for the search. call: asked about the models of the last
  /// setup. A frame before it that was never searched is forgotten.
  void send_frame(const RgbdFrame& frame, const DetectCall& call, const std::vector<ObjectModel>& models);
  /// Between two frames that are far apart: workers that hear nothing for minutes give up.
  void keep_alive();
  /// Searches the frame sent last. The outcome is the one of LaneSearch::run.
  std::vector<SearchOutcome> run(const LaneSearchProblem& problem);
  /// Ends the workers.
  void end();

  std::size_t lost() const;
  /// A lost rank of another machine may still be there; only MPI_Abort gets rid of it.
  bool lost_elsewhere() const;
  std::uint64_t moved() const { return moved_; }

 private:
  struct Worker {
    int rank = 0;
    std::int64_t process = 0;
    bool here = false;  ///< on this machine
    bool spoke = false, lost = false;
    double last_heard = 0;
    LaneShare share;
    StatusMessage status;
    bool fresh = false;            ///< status is of this pass
    std::uint64_t sent_nodes = 0;  ///< kTake messages of this frame
    int wanted_by = -1;            ///< index of the idle worker for which nodes were asked; -2: this rank
    std::vector<LaneNode> responsible;  ///< what was moved to it and may not be finished

    bool idle() const { return lost || (fresh && status.waiting == 0 && status.taken == sent_nodes); }
  };
  static constexpr int kNobody = -1;
  static constexpr int kMyself = -2;

  void close_frame();
  bool handle_messages();
  void handle(const ReceivedMessage& m);
  /// waiting: for the next frame; then nobody speaks, and silence means nothing.
  void look_for_lost(bool waiting = false);
  void lose(Worker& w, const char* why);
  void broadcast_bests();
  void delegate();
  void feed(int idle);
  void move_to(Worker& w, std::vector<LaneNode> nodes);
  bool all_idle() const;
  bool end_pass();
  std::vector<SearchOutcome> stop(bool complete, std::size_t targets);

  CoordinatorOptions options_;
  std::string host_;
  Mailbox mail_;
  std::vector<Worker> workers_;  ///< ranks 1..
  LaneSearch engine_;
  SearchStamp stamp_;
  bool frame_open_ = false;  ///< workers have a frame and wait for its search
  std::vector<ScoredPose> told_;
  std::vector<LaneNode> pool_;  ///< taken back and not yet moved on
  std::vector<double> bounds_;  ///< after kStop, of the workers that answered
  std::size_t answers_ = 0;
  std::uint64_t moved_ = 0;
  std::uint64_t my_nodes_ = 0, nodes_elsewhere_ = 0;
  double search_start_ = 0, last_look_ = 0;
};

}  // namespace sextant
