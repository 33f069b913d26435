// SPDX-License-Identifier: Apache-2.0
// Choosing, resuming and sharing the work, with trials whose answers are known.
#include "offline/tune/tuning.h"

#include <gtest/gtest.h>

#include <fstream>

#include "runtime/base/error.h"
#include "tests/support/temporary_folder.h"

namespace sextant {
namespace {

class Tuning : public testing::Test {
 protected:
  Tuning() {
    run_.sweeps = {{"a", {"1", "2", "3"}}, {"b", {"7"}}};
    run_.folder = folder_.path();
    run_.identity = "mesh and images";
  }
  /// AP 0.5 + 0.1 a (a = 3 is bad) + 0.05 for b = 7; on the held-out half 0.2 less.
  Trial trial() {
    return [this](const TunePoint& point, Half half) {
      ++calls_;
      TrialScore score;
      score.images = 10;
      score.average_precision = half == Half::kTraining ? 0.5 : 0.3;
      if (const auto a = point.find("a"); a != point.end())
        score.average_precision += a->second == "3" ? -0.1 : 0.1 * std::stod(a->second);
      if (point.count("b") > 0) score.average_precision += 0.05;
      return score;
    };
  }
  TemporaryFolder folder_;
  TuneRun run_;
  int calls_ = 0;
};

TEST_F(Tuning, TheCombinationOfTheBestIsTriedAndHeldAgainstTheOtherHalf) {
  const TuneResult result = finish_run(run_, trial());
  ASSERT_EQ(6U, result.points.size());
  EXPECT_EQ((TunePoint{{"a", "2"}, {"b", "7"}}), result.points.back());
  EXPECT_EQ(5U, result.best);
  EXPECT_NEAR(0.75, result.training[5].average_precision, 1e-12);
  EXPECT_NEAR(0.3, result.held_out_defaults.average_precision, 1e-12);
  EXPECT_NEAR(0.55, result.held_out_best.average_precision, 1e-12);
  EXPECT_EQ(8, calls_) << "5 points, the combination, 2 on the held-out half";
}

TEST_F(Tuning, GoesOnWhereItWasStopped) {
  finish_run(run_, trial());
  calls_ = 0;
  finish_run(run_, trial());
  EXPECT_EQ(0, calls_);
  // A damaged answer is found again, a further value alone is new.
  std::ofstream(trial_file(run_, {{"a", "1"}}, Half::kTraining)) << "{\"key\": 3";
  run_.sweeps[0].values.emplace_back("0.5");
  finish_run(run_, trial());
  EXPECT_EQ(2, calls_);
  calls_ = 0;
  run_.identity = "other images";
  finish_run(run_, trial());
  EXPECT_EQ(9, calls_);
}

TEST_F(Tuning, SharesAddUpToTheWhole) {
  run_.stride = 2;
  for (run_.first = 0; run_.first < 2; ++run_.first) run_share(run_, trial());
  EXPECT_EQ(5, calls_);
  const TuneResult result = finish_run(run_, trial());
  EXPECT_EQ(8, calls_) << "the combination and the held-out half are left";
  EXPECT_EQ(5U, result.best);
}

TEST_F(Tuning, TiesKeepTheDefaults) {
  run_.metric = "right";
  const TuneResult result = finish_run(run_, trial());
  EXPECT_EQ(0U, result.best);
  EXPECT_EQ(5U, result.points.size()) << "nothing to combine";
  run_.metric = "beauty";
  EXPECT_THROW(finish_run(run_, trial()), UsageError);
}

}  // namespace
}  // namespace sextant
