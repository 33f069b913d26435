// SPDX-License-Identifier: Apache-2.0
// The promises of the 16-bit storage: how much rounding can lose, and that it happens only once.
#include "runtime/model/quantisation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "synthetic_model.h"

namespace sextant {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

TEST(StepExponent, IsTheSmallestThatFits) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-20, 5);
  for (int i = 0; i < 10000; ++i) {
    const double largest = std::exp2(exponent(random));
    const int e = step_exponent(largest);
    EXPECT_LE(std::round(std::ldexp(largest, -e)), 32767);
    if (e > kMinStepExponent) {
      EXPECT_GT(std::round(std::ldexp(largest, -e + 1)), 32767);
    }
    // What is restored, even disturbed by a quarter of a step, asks for the same step.
    const double restored = std::ldexp(in_steps(largest, e), e);
    if (e > kMinStepExponent) {
      EXPECT_EQ(step_exponent(restored + std::ldexp(0.24, e)), e);
      EXPECT_EQ(step_exponent(restored - std::ldexp(0.24, e)), e);
    }
  }
  EXPECT_EQ(step_exponent(0), kMinStepExponent);
  EXPECT_GT(step_exponent(65), kMaxStepExponent);
}

TEST(LogCode, IsMonotoneAndWithinAThousandth) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> exponent(-47.9, 14.9);
  for (int i = 0; i < 100000; ++i) {
    const auto value = static_cast<float>(std::exp2(exponent(random)));
    EXPECT_NEAR(from_log_code(log_code(value)) / value, 1, 0.0004);
  }
  for (unsigned code = 0; code < 65535; ++code) {
    ASSERT_LT(from_log_code(static_cast<std::uint16_t>(code)),
              from_log_code(static_cast<std::uint16_t>(code + 1)));
    ASSERT_EQ(log_code(from_log_code(static_cast<std::uint16_t>(code))), code);
  }
  EXPECT_EQ(from_log_code(log_code(0)), 0);
  EXPECT_EQ(from_log_code(log_code(0x1p-20F)), 0x1p-20F);
}

// exp2 may differ by an ulp between CPUs. Float hides that unless a value lies next to the middle between two
// floats: none does, so every machine restores the same numbers.
TEST(LogCode, RestoresTheSameFloatOnEveryCpu) {
  for (int i = 0; i < 1024; ++i) {
    const double mantissa = std::exp2(i / 1024.0);
    const double in_half_ulps = std::ldexp(mantissa, 24);
    const double fraction = in_half_ulps - std::floor(in_half_ulps);
    const bool near_a_tie =
        std::fmod(std::round(in_half_ulps), 2) == 1 && std::min(fraction, 1 - fraction) < 1e-6;
    EXPECT_FALSE(near_a_tie) << i;
  }
}

double value_at(const std::array<float, 4>& form, double rx, double ry, double rz) {
  return form[0] + form[1] * rx + form[2] * ry + form[3] * rz;
}

/// Largest difference over the box between forms before and after storage: at its corners, as both are
/// linear.
double largest_loss(const std::array<float, 4>& before, const std::array<float, 4>& after,
                    const RotationBox& box) {
  double largest = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto angle = [&](std::size_t i) {
      return ((corner >> i & 1U) != 0 ? box.hi_deg[i] : box.lo_deg[i]) * kRadians;
    };
    const double a = value_at(before, angle(0), angle(1), angle(2));
    const double b = value_at(after, angle(0), angle(1), angle(2));
    largest = std::max(largest, std::abs(a - b));
  }
  return largest;
}

TEST(LinearForms, LoseLessThanTheBoundSays) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const ObjectModel model = test::make_random_model(1, 50, 0.02 + 0.002 * static_cast<double>(seed), seed);
    const ViewpointBin& bin = model.bins[0];
    std::vector<std::array<float, 4>> forms;
    for (const VisualPart& part : bin.visual) forms.push_back(part.u);
    const QuantisedForms stored = quantise_forms(forms, bin.box);
    const double bound = largest_rounding_error(stored.exponents, bin.box);
    EXPECT_LE(bound, kPositionRoundingLimit * rounding_limit_scale(model.bounding_radius_m));
    EXPECT_TRUE(centre_step_is_sound(stored.exponents, stored.planes, bin.box));
    const auto restored = restore_forms(stored.exponents, stored.planes, bin.box);
    for (std::size_t k = 0; k < forms.size(); ++k) {
      EXPECT_LE(largest_loss(forms[k], restored[k], bin.box), bound);
    }
    const QuantisedForms again = quantise_forms(restored, bin.box);
    EXPECT_EQ(again.exponents, stored.exponents);
    EXPECT_EQ(again.planes, stored.planes);
  }
}

TEST(LinearForms, WithoutPartsOrWithZerosAreFine) {
  const RotationBox box{{0, 0, 0}, {20, 20, 20}};
  EXPECT_TRUE(quantise_forms({}, box).planes.empty());
  const std::vector<std::array<float, 4>> zeros(3);
  const QuantisedForms stored = quantise_forms(zeros, box);
  EXPECT_EQ(restore_forms(stored.exponents, stored.planes, box), zeros);
}

}  // namespace
}  // namespace sextant
