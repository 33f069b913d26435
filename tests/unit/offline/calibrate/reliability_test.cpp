// SPDX-License-Identifier: Apache-2.0
#include "offline/calibrate/reliability.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(Reliability, KnownAnswers) {
  // Ten answers of 0.8, of which six are right; ten of 0.99, all right.
  std::vector<Answer> answers;
  for (int i = 0; i < 10; ++i) answers.push_back({0.8, i < 6});
  for (int i = 0; i < 10; ++i) answers.push_back({0.99, true});
  const Reliability r = reliability(answers);
  EXPECT_NEAR(r.expected_error, 0.5 * 0.2 + 0.5 * 0.01, 1e-9);
  EXPECT_EQ(r.bins[8].answers, 10);
  EXPECT_NEAR(r.bins[8].share_right, 0.6, 1e-9);
  EXPECT_EQ(r.sure, 10);
  EXPECT_EQ(r.sure_and_right, 10);
}

TEST(Reliability, ExtremesAndNothing) {
  EXPECT_EQ(reliability({}).expected_error, 0);
  const Reliability r = reliability({{1.0, true}, {0.0, false}});
  EXPECT_EQ(r.expected_error, 0);
  EXPECT_EQ(r.bins.front().answers + r.bins.back().answers, 2);
}

}  // namespace
}  // namespace sextant
