// SPDX-License-Identifier: Apache-2.0
// The threads of tables and search. Work is a count of independent items; which thread takes which item never
// changes the result, because items write only to their own slot.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace sextant {

class WorkerPool {
 public:
  /// threads: total including the caller; 0 = all cores; 1 = no thread is started.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }

  /// Calls work(i) once for every i in 0..count-1 and returns when all are done. The first exception that an
  /// item throws is thrown again here.
  void for_each(std::size_t count, const std::function<void(std::size_t)>& work);

 private:
  void run();
  void take_items();

  std::vector<std::thread> workers_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::condition_variable done_;
  const std::function<void(std::size_t)>* work_ = nullptr;
  std::size_t count_ = 0;
  std::atomic<std::size_t> next_{0};
  std::size_t busy_ = 0;
  std::uint64_t round_ = 0;
  bool stop_ = false;
  std::exception_ptr error_;
};

}  // namespace sextant
