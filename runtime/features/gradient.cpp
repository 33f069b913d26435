// SPDX-License-Identifier: Apache-2.0
// Rows pass through three rings: horizontal sums of three pixels, smoothed rows, gradients. Channels stay
// interleaved (a pixel's neighbour is three values away) until the longest gradient of each pixel is chosen.
#include "runtime/features/gradient.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/features/gradient.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sextant {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// out[i] = in[i - 3] + 2 in[i] + in[i + 3] for i < count. Rows may be read and written a vector further.
void horizontal_sums(const std::uint8_t* in, std::size_t count, std::int16_t* out) {
  const hn::ScalableTag<std::int16_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const auto load = [&](const std::uint8_t* at) HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(bytes, at)); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto middle = load(in + i);
    hn::StoreU(hn::Add(hn::Add(load(in + i - 3), load(in + i + 3)), hn::Add(middle, middle)), d, out + i);
  }
}

/// out = (above + 2 here + below + 8) / 16.
void smoothed_row(const std::int16_t* above, const std::int16_t* here, const std::int16_t* below,
                  std::size_t count, std::int16_t* out) {
  const hn::ScalableTag<std::int16_t> d;
  const auto half = hn::Set(d, std::int16_t{8});
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto middle = hn::LoadU(d, here + i);
    const auto sum =
        hn::Add(hn::Add(hn::LoadU(d, above + i), hn::LoadU(d, below + i)), hn::Add(middle, middle));
    hn::StoreU(hn::ShiftRight<4>(hn::Add(sum, half)), d, out + i);
  }
}

/// Sobel of three smoothed rows, channel by channel.
void sobel_row(const std::int16_t* above, const std::int16_t* here, const std::int16_t* below,
               std::size_t count, std::int16_t* gx, std::int16_t* gy) {
  const hn::ScalableTag<std::int16_t> d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto column = [&](std::ptrdiff_t shift) HWY_ATTR {
      const auto middle = hn::LoadU(d, here + i + shift);
      return hn::Add(hn::Add(hn::LoadU(d, above + i + shift), hn::LoadU(d, below + i + shift)),
                     hn::Add(middle, middle));
    };
    const auto step = [&](std::ptrdiff_t shift) HWY_ATTR {
      return hn::Sub(hn::LoadU(d, below + i + shift), hn::LoadU(d, above + i + shift));
    };
    const auto middle = step(0);
    hn::StoreU(hn::Sub(column(3), column(-3)), d, gx + i);
    hn::StoreU(hn::Add(hn::Add(step(-3), step(3)), hn::Add(middle, middle)), d, gy + i);
  }
}

/// Of each pixel's three channels the longest gradient; the first of equals.
#if HWY_TARGET == HWY_SCALAR
void longest_row(const std::int16_t* gx, const std::int16_t* gy, std::size_t pixels, std::int16_t* dx,
                 std::int16_t* dy) {
  for (std::size_t x = 0; x < pixels; ++x) {
    const auto norm = [&](std::size_t c) {
      return gx[3 * x + c] * gx[3 * x + c] + gy[3 * x + c] * gy[3 * x + c];
    };
    std::size_t best = norm(1) > norm(0) ? 1 : 0;
    if (norm(2) > norm(best)) best = 2;
    dx[x] = gx[3 * x + best];
    dy[x] = gy[3 * x + best];
  }
}
#else
void longest_row(const std::int16_t* gx, const std::int16_t* gy, std::size_t pixels, std::int16_t* dx,
                 std::int16_t* dy) {
  const hn::ScalableTag<std::int16_t> d;
  const hn::RepartitionToWide<decltype(d)> wide;
  for (std::size_t x = 0; x < pixels; x += hn::Lanes(d)) {
    auto x0 = hn::Zero(d);
    auto x1 = x0;
    auto x2 = x0;
    auto y0 = x0;
    auto y1 = x0;
    auto y2 = x0;
    hn::LoadInterleaved3(d, gx + 3 * x, x0, x1, x2);
    hn::LoadInterleaved3(d, gy + 3 * x, y0, y1, y2);
    // Squared lengths need 32 bits: the even and the odd pixels in turn.
    const auto even = [&](auto v)
                          HWY_ATTR { return hn::ShiftRight<16>(hn::ShiftLeft<16>(hn::BitCast(wide, v))); };
    const auto odd = [&](auto v) HWY_ATTR { return hn::ShiftRight<16>(hn::BitCast(wide, v)); };
    const auto square = [&](auto u, auto v) HWY_ATTR { return hn::Add(hn::Mul(u, u), hn::Mul(v, v)); };
    const auto longer = [&](auto ax, auto ay, auto bx, auto by) HWY_ATTR {  // is b longer than a
      const auto at_even = hn::Gt(square(even(bx), even(by)), square(even(ax), even(ay)));
      const auto at_odd = hn::Gt(square(odd(bx), odd(by)), square(odd(ax), odd(ay)));
      const auto lower = hn::Set(wide, 0xFFFF);
      const auto both = hn::Or(hn::And(hn::VecFromMask(wide, at_even), lower),
                               hn::AndNot(lower, hn::VecFromMask(wide, at_odd)));
      return hn::MaskFromVec(hn::BitCast(d, both));
    };
    const auto take = [&](auto mask, auto& ax, auto& ay, auto bx, auto by) HWY_ATTR {
      ax = hn::IfThenElse(mask, bx, ax);
      ay = hn::IfThenElse(mask, by, ay);
    };
    take(longer(x0, y0, x1, y1), x0, y0, x1, y1);
    take(longer(x0, y0, x2, y2), x0, y0, x2, y2);
    hn::StoreU(x0, d, dx + x);
    hn::StoreU(y0, d, dy + x);
  }
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace sextant
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sextant {
namespace {

constexpr std::size_t kMargin = 256;  ///< values that vectors may read or write beside a row

HWY_EXPORT(horizontal_sums);
HWY_EXPORT(smoothed_row);
HWY_EXPORT(sobel_row);
HWY_EXPORT(longest_row);

/// A row of 3 * pixels values with room for vectors on both sides.
template <typename T>
class PaddedRow {
 public:
  explicit PaddedRow(std::size_t values) : storage_(values + 2 * kMargin) {}
  T* values() { return storage_.data() + kMargin; }
  const T* values() const { return storage_.data() + kMargin; }
  /// The first and last pixel once more outside.
  void replicate_ends(std::size_t values_in_row) {
    T* row = values();
    for (std::ptrdiff_t c = 0; c < 3; ++c) {
      row[c - 3] = row[c];
      row[static_cast<std::ptrdiff_t>(values_in_row) + c] =
          row[static_cast<std::ptrdiff_t>(values_in_row) - 3 + c];
    }
  }

 private:
  std::vector<T> storage_;
};

template <typename T>
using Ring = std::array<PaddedRow<T>, 3>;

template <typename T>
Ring<T> ring(std::size_t values) {
  return {PaddedRow<T>(values), PaddedRow<T>(values), PaddedRow<T>(values)};
}

}  // namespace

void strongest_gradient(const cv::Mat& colour, Gradient& out) {
  CV_Assert(colour.type() == CV_8UC3 && !colour.empty());
  out.dx.create(colour.size(), CV_16SC1);
  out.dy.create(colour.size(), CV_16SC1);
  const int rows = colour.rows;
  const auto pixels = static_cast<std::size_t>(colour.cols);
  const std::size_t count = 3 * pixels;
  PaddedRow<std::uint8_t> bytes(count);
  Ring<std::int16_t> sums = ring<std::int16_t>(count);
  Ring<std::int16_t> smooth = ring<std::int16_t>(count);
  PaddedRow<std::int16_t> gx(count);
  PaddedRow<std::int16_t> gy(count);
  PaddedRow<std::int16_t> dx(count);
  PaddedRow<std::int16_t> dy(count);
  const auto of = [](auto& from, int y) { return from[static_cast<std::size_t>(y + 3) % 3].values(); };
  const auto clamped = [&](int y) { return std::clamp(y, 0, rows - 1); };

  const auto sum_row = [&](int y) {
    const std::uint8_t* row = colour.ptr<std::uint8_t>(y);
    std::copy(row, row + count, bytes.values());
    bytes.replicate_ends(count);
    HWY_DYNAMIC_DISPATCH(horizontal_sums)(bytes.values(), count, of(sums, y));
  };
  const auto smooth_row = [&](int y) {  // needs the sums of the rows above, here and below
    HWY_DYNAMIC_DISPATCH(smoothed_row)
    (of(sums, clamped(y - 1)), of(sums, y), of(sums, clamped(y + 1)), count, of(smooth, y));
    smooth[static_cast<std::size_t>(y) % 3].replicate_ends(count);
  };

  sum_row(0);
  if (rows > 1) sum_row(1);
  smooth_row(0);
  for (int y = 0; y < rows; ++y) {
    if (y + 1 < rows) {
      if (y + 2 < rows) sum_row(y + 2);
      smooth_row(y + 1);
    }
    HWY_DYNAMIC_DISPATCH(sobel_row)
    (of(smooth, clamped(y - 1)), of(smooth, y), of(smooth, clamped(y + 1)), count, gx.values(), gy.values());
    HWY_DYNAMIC_DISPATCH(longest_row)(gx.values(), gy.values(), pixels, dx.values(), dy.values());
    std::copy(dx.values(), dx.values() + pixels, out.dx.ptr<std::int16_t>(y));
    std::copy(dy.values(), dy.values() + pixels, out.dy.ptr<std::int16_t>(y));
  }
}

}  // namespace sextant
#endif  // HWY_ONCE
