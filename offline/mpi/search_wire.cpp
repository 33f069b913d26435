// SPDX-License-Identifier: Apache-2.0
#include "offline/mpi/search_wire.h"

#include <limits>

namespace sextant {

void Mailbox::send(int to, SearchTag tag, Bytes bytes) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::logic_error("a message between ranks is too large");
  }
  Sending& s = sending_.emplace_back();
  s.bytes = std::move(bytes);
  // An error here is a dead receiver: its silence is noticed by whoever waits for it.
  if (MPI_Isend(s.bytes.data(), static_cast<int>(s.bytes.size()), MPI_BYTE, to, static_cast<int>(tag),
                MPI_COMM_WORLD, &s.request) != MPI_SUCCESS) {
    sending_.pop_back();
    return;
  }
  std::erase_if(sending_, [](Sending& one) {
    int done = 0;
    return MPI_Test(&one.request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS && done != 0;
  });
}

std::optional<ReceivedMessage> Mailbox::receive() {
  int there = 0;
  MPI_Status status;
  if (MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status) != MPI_SUCCESS || there == 0) {
    return std::nullopt;
  }
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  ReceivedMessage m{status.MPI_SOURCE, static_cast<SearchTag>(status.MPI_TAG),
                    Bytes(static_cast<std::size_t>(size))};
  if (MPI_Recv(m.bytes.data(), size, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD,
               MPI_STATUS_IGNORE) != MPI_SUCCESS) {
    return std::nullopt;
  }
  return m;
}

}  // namespace sextant
