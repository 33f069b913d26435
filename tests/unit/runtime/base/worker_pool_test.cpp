// SPDX-License-Identifier: Apache-2.0
#include "runtime/base/worker_pool.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace sextant {
namespace {

TEST(WorkerPool, DoesEveryItemOnceAndPassesErrorsOn) {
  WorkerPool pool(4);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::atomic<int>> done(50);
    pool.for_each(done.size(), [&](std::size_t i) { ++done[i]; });
    for (const auto& d : done) ASSERT_EQ(d, 1);
  }
  EXPECT_THROW(pool.for_each(10,
                             [](std::size_t i) {
                               if (i == 7) throw std::runtime_error("seven");
                             }),
               std::runtime_error);
  int after = 0;
  pool.for_each(1, [&](std::size_t) { ++after; });
  EXPECT_EQ(after, 1);
}

}  // namespace
}  // namespace sextant
