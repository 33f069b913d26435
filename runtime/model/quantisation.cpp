// SPDX-License-Identifier: Apache-2.0
#include "runtime/model/quantisation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sextant {
namespace {

constexpr double kLogCodesPerOctave = 1024;
constexpr double kRadians = std::numbers::pi / 180;

std::array<double, 3> centre_of(const RotationBox& box) {
  std::array<double, 3> centre{};
  for (std::size_t i = 0; i < 3; ++i) centre[i] = (box.lo_deg[i] + box.hi_deg[i]) * (0.5 * kRadians);
  return centre;
}

/// What the slopes of form k, as stored, add between angle 0 and the centre.
double shift_to_centre(const std::array<int, 4>& exponents, std::span<const std::int16_t> planes,
                       std::size_t k, const std::array<double, 3>& centre) {
  const std::size_t n = planes.size() / 4;
  double shift = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    shift += std::ldexp(static_cast<double>(planes[(i + 1) * n + k]), exponents[i + 1]) * centre[i];
  }
  return shift;
}

/// Smallest exponent that the value at the centre may use: 2^e >= 2^-21 * the largest shift.
int smallest_centre_exponent(const std::array<int, 4>& exponents, std::span<const std::int16_t> planes,
                             const std::array<double, 3>& centre) {
  double largest = 0;
  for (std::size_t k = 0; k < planes.size() / 4; ++k) {
    largest = std::max(largest, std::abs(shift_to_centre(exponents, planes, k, centre)));
  }
  int e = kMinStepExponent;
  while (e <= kMaxStepExponent && std::ldexp(1.0, e + 21) < largest) ++e;
  return e;
}

}  // namespace

double rounding_limit_scale(double bounding_radius_m) { return std::max(1.0, bounding_radius_m / 0.25); }

int step_exponent(double largest, int at_least) {
  int e = std::max(at_least, kMinStepExponent);
  while (e <= kMaxStepExponent && std::round(std::ldexp(std::abs(largest), -e)) > 32767) ++e;
  return e;
}

std::int16_t in_steps(double value, int exponent) {
  return static_cast<std::int16_t>(std::clamp(std::round(std::ldexp(value, -exponent)), -32767.0, 32767.0));
}

QuantisedForms quantise_forms(std::span<const std::array<float, 4>> forms, const RotationBox& box) {
  const std::array<double, 3> centre = centre_of(box);
  const std::size_t n = forms.size();
  QuantisedForms out;
  out.planes.resize(4 * n);
  for (std::size_t i = 1; i < 4; ++i) {
    double largest = 0;
    for (const auto& form : forms) largest = std::max(largest, std::abs(static_cast<double>(form[i])));
    out.exponents[i] = step_exponent(largest);
    for (std::size_t k = 0; k < n; ++k) out.planes[i * n + k] = in_steps(forms[k][i], out.exponents[i]);
  }
  std::vector<double> at_centre(n);
  double largest = 0;
  for (std::size_t k = 0; k < n; ++k) {
    // In the order of shift_to_centre, so that restored forms give exactly what was stored.
    double shift = 0;
    for (std::size_t i = 0; i < 3; ++i) shift += static_cast<double>(forms[k][i + 1]) * centre[i];
    at_centre[k] = forms[k][0] + shift;
    largest = std::max(largest, std::abs(at_centre[k]));
  }
  out.exponents[0] = step_exponent(largest, smallest_centre_exponent(out.exponents, out.planes, centre));
  for (std::size_t k = 0; k < n; ++k) out.planes[k] = in_steps(at_centre[k], out.exponents[0]);
  return out;
}

std::vector<std::array<float, 4>> restore_forms(const std::array<int, 4>& exponents,
                                                std::span<const std::int16_t> planes,
                                                const RotationBox& box) {
  const std::array<double, 3> centre = centre_of(box);
  const std::size_t n = planes.size() / 4;
  std::vector<std::array<float, 4>> forms(n);
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 1; i < 4; ++i) {
      forms[k][i] = static_cast<float>(std::ldexp(static_cast<double>(planes[i * n + k]), exponents[i]));
    }
    forms[k][0] = static_cast<float>(std::ldexp(static_cast<double>(planes[k]), exponents[0]) -
                                     shift_to_centre(exponents, planes, k, centre));
  }
  return forms;
}

double largest_rounding_error(const std::array<int, 4>& exponents, const RotationBox& box) {
  // Half a step at the centre, and an eighth for the float constant term.
  double error = std::ldexp(0.625, exponents[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const double half_width = (box.hi_deg[i] - box.lo_deg[i]) * (0.5 * kRadians);
    error += std::ldexp(0.5, exponents[i + 1]) * half_width;
  }
  return error;
}

bool centre_step_is_sound(const std::array<int, 4>& exponents, std::span<const std::int16_t> planes,
                          const RotationBox& box) {
  return exponents[0] >= smallest_centre_exponent(exponents, planes, centre_of(box));
}

std::uint16_t log_code(float value) {
  if (value <= 0) return 0;
  const double code = std::round((std::log2(static_cast<double>(value)) + 48) * kLogCodesPerOctave) + 1;
  return static_cast<std::uint16_t>(std::clamp(code, 1.0, 65535.0));
}

float from_log_code(std::uint16_t code) {
  if (code == 0) return 0;
  return static_cast<float>(std::exp2((code - 1) / kLogCodesPerOctave - 48));
}

std::uint8_t share_code(float share) {
  return static_cast<std::uint8_t>(std::clamp(std::round(share * 255), 1.0F, 254.0F));
}

float from_share_code(std::uint8_t code) { return static_cast<float>(code) / 255; }

}  // namespace sextant
