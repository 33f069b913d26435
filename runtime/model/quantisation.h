// SPDX-License-Identifier: Apache-2.0
// 16-bit storage of model numbers (idl/model/object_model.fbs). Steps are powers of two, so that what was
// read is exact in float and writing it again finds the same integers:
//
// The step of a set is the smallest 2^e with round(max |x| / 2^e) <= 32767. For the stored integers q that
// means max |q| >= 16384 (one step finer would have exceeded 32767), so the restored set q 2^e asks for the
// same e, also if each restored value is off by up to a quarter of a step.
//
// Linear forms are stored at the bin's centre because the constant term, an extrapolation to angle 0, can be
// many times larger than any value that the form takes inside the bin. Their centre step is at least 2^-21
// of the largest difference between both, so that float holds the constant term to an eighth of a step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/model/object_model.h"

namespace sextant {

/// Largest error that rounding may cause in an expected position, tangent * metre: 0.05 px of a camera of
/// 525 px focal length at 0.5 m. Objects of more than 0.25 m radius are not seen from 0.5 m: for them both
/// limits grow with the radius.
inline constexpr double kPositionRoundingLimit = 0.05 * 0.5 / 525;
/// The same for an expected depth, metres.
inline constexpr double kDepthRoundingLimit = 1e-4;
double rounding_limit_scale(double bounding_radius_m);

/// Exponents of steps that a file may hold: values stay below 64.
inline constexpr int kMinStepExponent = -24;
inline constexpr int kMaxStepExponent = -9;

/// The smallest exponent e >= at_least such that |largest| / 2^e rounds to at most 32767. At most
/// kMaxStepExponent + 1 (too large to store). `largest` must be finite.
int step_exponent(double largest, int at_least = kMinStepExponent);
/// The nearest whole number of steps, which must fit.
std::int16_t in_steps(double value, int exponent);

/// Linear forms c0 + c1 rx + c2 ry + c3 rz of one bin.
struct QuantisedForms {
  std::array<int, 4> exponents{};    ///< of the steps: value at the centre, slopes of rx, ry, rz
  std::vector<std::int16_t> planes;  ///< values at the centre of all forms, then their slopes of rx, ry, rz
};

/// Stores forms. Exponents exceed kMaxStepExponent where a coefficient is too large.
QuantisedForms quantise_forms(std::span<const std::array<float, 4>> forms, const RotationBox& box);

/// The forms again. `planes` holds four planes of equal size, exponents within the limits.
std::vector<std::array<float, 4>> restore_forms(const std::array<int, 4>& exponents,
                                                std::span<const std::int16_t> planes, const RotationBox& box);

/// Largest error that rounding to these steps causes anywhere in the box (closed), in the unit of the values.
double largest_rounding_error(const std::array<int, 4>& exponents, const RotationBox& box);

/// Whether the centre's step keeps the restored constant terms within an eighth of it (see above). Files of
/// quantise_forms always do; the reader asks so that everything it accepts can be written again.
bool centre_step_is_sound(const std::array<int, 4>& exponents, std::span<const std::int16_t> planes,
                          const RotationBox& box);

/// LogCode: positive numbers within 2^-48..2^15.99 to 0.034 %; 0 is code 0. Monotone.
inline constexpr double kLogCodeMin = 0x1p-48;
inline constexpr double kLogCodeMax = 0x1p15;
std::uint16_t log_code(float value);
float from_log_code(std::uint16_t code);

/// ShareCode: shares in steps of 1/255, never quite 0 or 1 (codes 1..254).
std::uint8_t share_code(float share);
float from_share_code(std::uint8_t code);

}  // namespace sextant
