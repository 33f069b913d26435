// SPDX-License-Identifier: Apache-2.0
#include "runtime/features/thinning.h"

#include <algorithm>
#include <array>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/features/thinning.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sextant {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Squared lengths.
void norm_row(const std::int16_t* dx, const std::int16_t* dy, std::size_t width, std::int32_t* out) {
  const hn::ScalableTag<std::int32_t> d;
  const hn::Rebind<std::int16_t, decltype(d)> half;
  std::size_t x = 0;
  for (; x + hn::Lanes(d) <= width; x += hn::Lanes(d)) {
    const auto u = hn::PromoteTo(d, hn::LoadU(half, dx + x));
    const auto v = hn::PromoteTo(d, hn::LoadU(half, dy + x));
    hn::StoreU(hn::Add(hn::Mul(u, u), hn::Mul(v, v)), d, out + x);
  }
  for (; x < width; ++x) out[x] = dx[x] * dx[x] + dy[x] * dy[x];
}

/// marks: 2 where a norm above high2 is the largest across its edge, 1 where it is above low2, else 0. The
/// norms may be read one before and one after their row.
void mark_row(const std::int32_t* above, const std::int32_t* here, const std::int32_t* below,
              const std::int16_t* dx, const std::int16_t* dy, std::size_t width, std::int32_t low2,
              std::int32_t high2, std::uint8_t* marks) {
  constexpr std::int32_t kTan22 = 13573;  // tan(22.5 deg) * 2^15; tan(67.5 deg) = that + 2
  // Vectors read past the row's end, where the caller left no gradient: the rest goes through a copy.
  const hn::ScalableTag<std::int32_t> d;
  const hn::Rebind<std::int16_t, decltype(d)> half;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const std::size_t lanes = hn::Lanes(d);
  const auto mark = [&](std::size_t x, const std::int16_t* gx, const std::int16_t* gy) HWY_ATTR {
    const auto m = hn::LoadU(d, here + x);
    const auto weak = hn::Gt(m, hn::Set(d, low2));
    if (hn::AllFalse(d, weak)) return hn::Zero(bytes);
    const auto xs = hn::PromoteTo(d, hn::LoadU(half, gx));
    const auto ys = hn::PromoteTo(d, hn::LoadU(half, gy));
    const auto x_abs = hn::Abs(xs);
    const auto y_abs = hn::ShiftLeft<15>(hn::Abs(ys));
    const auto tan22 = hn::Mul(x_abs, hn::Set(d, kTan22));
    const auto across = hn::Lt(y_abs, tan22);
    const auto upright = hn::Gt(y_abs, hn::Add(tan22, hn::ShiftLeft<16>(x_abs)));
    const auto falling = hn::Lt(hn::Xor(xs, ys), hn::Zero(d));
    const auto at = [&](const std::int32_t* row, std::ptrdiff_t shift)
                        HWY_ATTR { return hn::LoadU(d, row + x + shift); };
    const auto first = hn::IfThenElse(
        across, at(here, -1),
        hn::IfThenElse(upright, at(above, 0), hn::IfThenElse(falling, at(above, 1), at(above, -1))));
    const auto second = hn::IfThenElse(
        across, at(here, 1),
        hn::IfThenElse(upright, at(below, 0), hn::IfThenElse(falling, at(below, -1), at(below, 1))));
    // Equal neighbours: along an axis the first of two counts, on a diagonal neither.
    const auto tie = hn::And(hn::VecFromMask(d, hn::Or(across, upright)), hn::Set(d, 1));
    const auto ridge = hn::And(hn::Gt(m, first), hn::Gt(hn::Add(m, tie), second));
    const auto one = hn::IfThenElseZero(hn::And(weak, ridge), hn::Set(d, 1));
    const auto strong = hn::VecFromMask(d, hn::Gt(m, hn::Set(d, high2)));
    return hn::DemoteTo(bytes, hn::Add(one, hn::And(one, strong)));
  };
  std::size_t x = 0;
  for (; x + lanes <= width; x += lanes) hn::StoreU(mark(x, dx + x, dy + x), bytes, marks + x);
  if (x < width) {
    HWY_ALIGN std::int16_t gx[HWY_MAX_BYTES / 4] = {};
    HWY_ALIGN std::int16_t gy[HWY_MAX_BYTES / 4] = {};
    HWY_ALIGN std::uint8_t rest[HWY_MAX_BYTES / 4];
    std::copy(dx + x, dx + width, gx);
    std::copy(dy + x, dy + width, gy);
    hn::StoreU(mark(x, gx, gy), bytes, rest);
    std::copy(rest, rest + (width - x), marks + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sextant
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sextant {
namespace {

constexpr std::size_t kMargin = 128;  ///< norms that vectors may read beside a row

HWY_EXPORT(norm_row);
HWY_EXPORT(mark_row);

}  // namespace

void Thinning::edges(const Gradient& gradient, int low, int high, cv::Mat& edges) {
  const int rows = gradient.dx.rows;
  const auto width = static_cast<std::size_t>(gradient.dx.cols);
  edges.create(gradient.dx.size(), CV_8UC1);
  const std::size_t stride = width + 2;
  marks_.assign(stride * static_cast<std::size_t>(rows + 2), 0);
  const std::size_t pitch = width + 2 * kMargin;
  norms_.assign(3 * pitch, 0);
  to_visit_.clear();

  const auto norms = [&](int y) {
    return norms_.data() + static_cast<std::size_t>(y + 3) % 3 * pitch + kMargin;
  };
  const auto fill = [&](int y) {
    if (y < rows) {
      HWY_DYNAMIC_DISPATCH(norm_row)
      (gradient.dx.ptr<std::int16_t>(y), gradient.dy.ptr<std::int16_t>(y), width, norms(y));
    } else {
      std::fill(norms(y), norms(y) + width, 0);
    }
  };
  fill(0);
  for (int y = 0; y < rows; ++y) {
    fill(y + 1);
    std::uint8_t* marks = marks_.data() + static_cast<std::size_t>(y + 1) * stride + 1;
    HWY_DYNAMIC_DISPATCH(mark_row)
    (norms(y - 1), norms(y), norms(y + 1), gradient.dx.ptr<std::int16_t>(y), gradient.dy.ptr<std::int16_t>(y),
     width, low * low, high * high, marks);
    for (std::uint8_t* m = marks; m < marks + width; ++m) {
      if (*m == 2) to_visit_.push_back(m);
    }
  }
  const auto down = static_cast<std::ptrdiff_t>(stride);
  const std::array<std::ptrdiff_t, 8> around{-down - 1, -down, -down + 1, -1, 1, down - 1, down, down + 1};
  while (!to_visit_.empty()) {
    std::uint8_t* from = to_visit_.back();
    to_visit_.pop_back();
    for (const std::ptrdiff_t step : around) {
      if (from[step] != 1) continue;
      from[step] = 2;
      to_visit_.push_back(from + step);
    }
  }
  for (int y = 0; y < rows; ++y) {
    const std::uint8_t* marks = marks_.data() + static_cast<std::size_t>(y + 1) * stride + 1;
    std::uint8_t* out = edges.ptr<std::uint8_t>(y);
    for (std::size_t x = 0; x < width; ++x) out[x] = marks[x] == 2 ? 255 : 0;
  }
}

}  // namespace sextant
#endif  // HWY_ONCE
