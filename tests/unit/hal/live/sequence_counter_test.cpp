// SPDX-License-Identifier: Apache-2.0
#include "hal/live/sequence_counter.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(SequenceCounter, CountsGaps) {
  SequenceCounter counter;
  EXPECT_EQ(counter.next(7).sequence, 0);  // nothing is known of those before the first
  EXPECT_EQ(counter.next(8).lost, 0U);
  const SequenceCounter::Step step = counter.next(12);
  EXPECT_EQ(step.sequence, 5);
  EXPECT_EQ(step.lost, 3U);
}

TEST(SequenceCounter, GoesOnOverTheWrap) {
  SequenceCounter counter;
  counter.next(0xfffffffe);
  EXPECT_EQ(counter.next(0xffffffff).sequence, 1);
  const SequenceCounter::Step step = counter.next(1);
  EXPECT_EQ(step.sequence, 3);
  EXPECT_EQ(step.lost, 1U);
}

TEST(SequenceCounter, ADeviceThatBeginsAnewLosesNothing) {
  SequenceCounter counter;
  counter.next(100);
  counter.next(101);
  EXPECT_EQ(counter.next(0).sequence, 2);
  EXPECT_EQ(counter.next(0).sequence, 3);  // one that does not count at all
  counter.restart();
  const SequenceCounter::Step step = counter.next(5000);
  EXPECT_EQ(step.sequence, 4);
  EXPECT_EQ(step.lost, 0U);
}

}  // namespace
}  // namespace sextant
