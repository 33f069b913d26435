// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/informative_parts.h"

#include <gtest/gtest.h>

#include "runtime/search/part_likelihood.h"

namespace sextant {
namespace {

VisualPart part(std::uint8_t kind, float found, float background, float spread) {
  VisualPart p;
  p.kind = kind;
  p.seen = {.spread = spread, .found = found, .background = background, .weight = 2};
  return p;
}

double total(const std::vector<VisualPart>& parts) {
  double sum = 0;
  for (const VisualPart& p : parts) {
    const PartLikelihood l = likelihood_of(p.seen, 2);
    sum += static_cast<double>(p.seen.weight) * (l.gain - l.out);
  }
  return sum;
}

TEST(InformativeParts, SharpPartsSayMoreThanVagueOnesAndFoundOnesMoreThanLostOnes) {
  const VisualPart sharp = part(0, 0.9F, 0.1F, 1e-6F);
  EXPECT_GT(information_of(sharp), information_of(part(0, 0.9F, 0.1F, 4e-6F)));
  EXPECT_GT(information_of(sharp), information_of(part(0, 0.5F, 0.1F, 1e-6F)));
  EXPECT_GT(information_of(sharp), information_of(part(0, 0.9F, 0.4F, 1e-6F)));
}

TEST(InformativeParts, UnmeasuredPartsAreJudgedByTheirVariance) {
  VisualPart sure = part(0, 0.75F, 0.15F, 0);
  VisualPart vague = sure;
  sure.variance = 1e-6F;
  vague.variance = 2e-6F;
  EXPECT_GT(information_of(sure), information_of(vague));
}

TEST(InformativeParts, KeepsTheBestInOrderAndTheirTotalEvidence) {
  std::vector<VisualPart> parts{part(0, 0.9F, 0.1F, 1e-6F), part(1, 0.9F, 0.1F, 9e-6F),
                                part(2, 0.8F, 0.1F, 1e-6F), part(3, 0.6F, 0.3F, 2e-6F)};
  const double before = total(parts);
  keep_most_informative(parts, 2);
  ASSERT_EQ(2U, parts.size());
  EXPECT_EQ(0, parts[0].kind);
  EXPECT_EQ(2, parts[1].kind);
  EXPECT_NEAR(before, total(parts), 1e-3);
}

TEST(InformativeParts, FewPartsStayAsTheyAre) {
  std::vector<VisualPart> parts{part(0, 0.9F, 0.1F, 1e-6F), part(1, 0.9F, 0.1F, 9e-6F)};
  keep_most_informative(parts, 2);
  EXPECT_EQ(2U, parts.size());
  EXPECT_FLOAT_EQ(2, parts[0].seen.weight);
}

}  // namespace
}  // namespace sextant
