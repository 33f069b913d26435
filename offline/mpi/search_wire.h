// SPDX-License-Identifier: Apache-2.0
// Messages between the coordinator (rank 0) and the workers of a distributed search (Davies 2015, Procs.
// 31-33), as plain structs: all ranks run the same program on machines of one kind. Between two ranks they
// arrive in the order in which they were sent.
#pragma once

#include <mpi.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <optional>
#include <vector>

#include "runtime/search/branch_and_bound.h"

namespace sextant {

enum class SearchTag : int {
  // to the coordinator
  kHello = 101,  ///< HelloMessage
  kStatus,       ///< StatusMessage
  kBest,         ///< BestMessage, both ways
  kNodes,        ///< SearchStamp, LaneNode...: what was asked for with kGive
  kBounds,       ///< SearchStamp, double per object: what still waits, after kStop
  // to a worker
  kSetup,    ///< SetupMessage and the options: forget what was
  kModel,    ///< bytes of a model file, as often as the setup said
  kFrame,    ///< FrameShare, what is asked for, a frame: search it
  kAlive,    ///< nothing: the coordinator is there, and has nothing to do
  kTake,     ///< SearchStamp, LaneNode...: these are yours now
  kGive,     ///< GiveMessage
  kAdvance,  ///< SearchStamp, ScoredPose per object: the pass is over
  kStop,     ///< SearchStamp: the search is over
  kEnd,      ///< EndMessage: the job is over
};

/// Which frame and pass a message belongs to.
struct SearchStamp {
  std::uint32_t frame = 0;
  std::uint32_t pass = 0;
};
struct HelloMessage {
  std::int64_t process = 0;
  std::array<char, 64> host{};
};
struct StatusMessage {
  SearchStamp stamp;
  std::uint64_t waiting = 0;  ///< nodes
  std::uint64_t kept = 0;     ///< nodes and poses that later passes may need
  std::uint64_t taken = 0;    ///< kTake messages of this frame so far
  std::uint64_t nodes = 0;    ///< bounded so far in this frame
  double nodes_per_s = 0;     ///< measured
};
struct BestMessage {
  SearchStamp stamp;
  std::uint64_t target = 0;
  ScoredPose pose;
};
struct GiveMessage {
  SearchStamp stamp;
  std::uint64_t most = 0;
};
/// together: MPI_Finalize, which waits for all ranks; else one of them is lost and everybody just leaves.
struct EndMessage {
  bool together = true;
};
struct SetupMessage {
  std::uint64_t models = 0;
};
/// Which share of the roots is the receiver's.
struct FrameShare {
  std::uint32_t frame = 0;
  std::uint32_t index = 0;
  std::uint32_t count = 1;
};

using Bytes = std::vector<std::byte>;

template <typename Plain>
void append(Bytes& bytes, const Plain& value) {
  static_assert(std::is_trivially_copyable_v<Plain>);
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// Takes values from the front of a message. A short one is our bug.
class ByteReader {
 public:
  explicit ByteReader(const Bytes& bytes) : bytes_(bytes) {}
  template <typename Plain>
  Plain take() {
    static_assert(std::is_trivially_copyable_v<Plain>);
    Plain value;
    std::memcpy(&value, take(sizeof value), sizeof value);
    return value;
  }
  template <typename Plain>
  std::vector<Plain> rest() {
    std::vector<Plain> values;
    while (left() >= sizeof(Plain)) values.push_back(take<Plain>());
    return values;
  }
  const std::byte* take(std::size_t count) {
    if (left() < count) throw std::logic_error("a message between ranks is too short");
    at_ += count;
    return bytes_.data() + at_ - count;
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

struct ReceivedMessage {
  int from = 0;
  SearchTag tag{};
  Bytes bytes;
};

/// Sends without ever waiting for the receiver, which may be dead: buffers live until they are delivered, or
/// until the end.
class Mailbox {
 public:
  void send(int to, SearchTag tag, Bytes bytes);
  template <typename Plain>
  void send_plain(int to, SearchTag tag, const Plain& value) {
    Bytes bytes;
    append(bytes, value);
    send(to, tag, std::move(bytes));
  }
  std::optional<ReceivedMessage> receive();

 private:
  struct Sending {
    Bytes bytes;
    MPI_Request request = MPI_REQUEST_NULL;
  };
  std::deque<Sending> sending_;
};

}  // namespace sextant
