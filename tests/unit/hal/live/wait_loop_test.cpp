// SPDX-License-Identifier: Apache-2.0
#include "hal/wait_loop.h"

#include <gtest/gtest.h>

#include <optional>

namespace sextant {
namespace {

using namespace std::chrono_literals;

TEST(WaitLoop, TriesUntilSomethingComes) {
  const std::atomic<bool> closed{false};
  int attempts = 0;
  const auto result = wait_for_result(1h, closed, [&](WaitClock::time_point) {
    return ++attempts == 3 ? std::optional<int>(42) : std::nullopt;
  });
  EXPECT_EQ(result, 42);
  EXPECT_EQ(attempts, 3);
}

TEST(WaitLoop, NoTimeIsOneAttempt) {
  const std::atomic<bool> closed{false};
  int attempts = 0;
  const auto nothing = [&](WaitClock::time_point) {
    ++attempts;
    return std::optional<int>();
  };
  EXPECT_FALSE(wait_for_result(0ms, closed, nothing).has_value());
  EXPECT_EQ(attempts, 1);
}

TEST(WaitLoop, WhatCameInTimeIsNotLeftForTheNextCall) {
  const std::atomic<bool> closed{false};
  int attempts = 0;
  const auto result = wait_for_result(1ms, closed, [&](WaitClock::time_point deadline) {
    if (++attempts == 2) return std::optional<int>(42);
    while (WaitClock::now() < deadline) {  // a wait that ends at the deadline
    }
    return std::optional<int>();
  });
  EXPECT_EQ(result, 42);
}

TEST(WaitLoop, ClosedBeforeOrWhileWaitingIsTheEnd) {
  std::atomic<bool> closed{true};
  int attempts = 0;
  const auto nothing = [&](WaitClock::time_point) {
    ++attempts;
    closed = true;
    return std::optional<int>();
  };
  EXPECT_FALSE(wait_for_result(1h, closed, nothing).has_value());
  EXPECT_EQ(attempts, 0);
  closed = false;
  EXPECT_FALSE(wait_for_result(1h, closed, nothing).has_value());
  EXPECT_EQ(attempts, 1);
}

TEST(WaitLoop, TheRestIsRoundedUpAndNeverNegative) {
  EXPECT_EQ(left_until(WaitClock::now() - 1s), 0ms);
  const auto left = left_until(WaitClock::now() + 1h);
  EXPECT_GT(left, 59min);
  EXPECT_LE(left, 1h);
}

}  // namespace
}  // namespace sextant
