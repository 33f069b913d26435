// SPDX-License-Identifier: Apache-2.0
// Separable: along the columns by two sweeps, then along the rows the lower envelope of parabolas, straight
// from its definition but only as far as a parabola can still lower a value.
#include "runtime/tables/distance_transform.h"

#include <algorithm>
#include <array>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/tables/distance_transform.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sextant {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One step of a sweep: steps[x] = 0 at a feature, else one more than before, at most `far`; out[x] = their
/// minimum.
void SweepRow(const std::uint8_t* edges, std::uint8_t bit, std::uint8_t far, std::size_t width,
              std::uint8_t* steps, std::uint8_t* out) {
  const hn::ScalableTag<std::uint8_t> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t x = 0;
  for (; x + lanes <= width; x += lanes) {
    const auto none = hn::Eq(hn::And(hn::LoadU(d, edges + x), hn::Set(d, bit)), hn::Zero(d));
    const auto next = hn::Min(hn::Add(hn::LoadU(d, steps + x), hn::Set(d, std::uint8_t{1})), hn::Set(d, far));
    const auto step = hn::IfThenElseZero(none, next);
    hn::StoreU(step, d, steps + x);
    hn::StoreU(hn::Min(step, hn::LoadU(d, out + x)), d, out + x);
  }
  for (; x < width; ++x) {
    steps[x] =
        (edges[x] & bit) ? std::uint8_t{0} : static_cast<std::uint8_t>(std::min(steps[x] + 1, int{far}));
    out[x] = std::min(out[x], steps[x]);
  }
}

/// out[x] = min over |d| <= clip of row[x + d] + d^2, 65535 above clip^2. row may be read clip values before
/// its start and 64 + clip after its end.
void EnvelopeRow(const std::uint16_t* row, int clip, std::size_t width, std::uint16_t* out) {
  const hn::ScalableTag<std::uint16_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto limit = hn::Set(d, static_cast<std::uint16_t>(clip * clip));
  const auto far = hn::Set(d, std::uint16_t{65535});
  for (std::size_t x = 0; x < width; x += lanes) {
    const std::uint16_t* at = row + x;
    auto best = hn::LoadU(d, at);
    for (int m = 1; m <= clip; ++m) {
      const auto square = hn::Set(d, static_cast<std::uint16_t>(m * m));
      // Parabolas from here on start at m^2: they cannot lower what is not higher.
      if ((m & 3) == 1 && hn::AllTrue(d, hn::Eq(hn::SaturatedSub(best, square), hn::Zero(d)))) break;
      const auto nearest = hn::Min(hn::LoadU(d, at - m), hn::LoadU(d, at + m));
      best = hn::Min(best, hn::SaturatedAdd(nearest, square));
    }
    const auto within = hn::Eq(hn::SaturatedSub(best, limit), hn::Zero(d));
    best = hn::IfThenElse(within, best, far);
    if (x + lanes <= width) {
      hn::StoreU(best, d, out + x);
    } else {
      HWY_ALIGN std::uint16_t rest[HWY_MAX_BYTES / 2];
      hn::Store(best, d, rest);
      std::copy(rest, rest + (width - x), out + x);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sextant
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sextant {
namespace {

constexpr std::uint16_t kFar = 65535;
constexpr std::size_t kMargin = 128;  ///< values that vectors may read past the end of a row

HWY_EXPORT(SweepRow);
HWY_EXPORT(EnvelopeRow);

}  // namespace

void clipped_distance2(const cv::Mat& edges, int kind, int clip_radius, std::uint16_t* out, int out_stride) {
  const auto width = static_cast<std::size_t>(edges.cols);
  const int height = edges.rows;
  const auto bit = static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
  const auto far = static_cast<std::uint8_t>(clip_radius + 1);
  // Distance along the column, `far` beyond the clip radius.
  std::vector<std::uint8_t> columns(width * static_cast<std::size_t>(height), far);
  std::vector<std::uint8_t> steps(width);
  const auto sweep = [&](int from, int to, int by) {
    std::fill(steps.begin(), steps.end(), far);
    for (int y = from; y != to; y += by) {
      HWY_DYNAMIC_DISPATCH(SweepRow)
      (edges.ptr<std::uint8_t>(y), bit, far, width, steps.data(),
       columns.data() + static_cast<std::size_t>(y) * width);
    }
  };
  sweep(0, height, 1);
  sweep(height - 1, -1, -1);

  std::array<std::uint16_t, 256> squares;
  for (std::size_t v = 0; v < squares.size(); ++v)
    squares[v] = v > static_cast<std::size_t>(clip_radius) ? kFar : static_cast<std::uint16_t>(v * v);
  const auto reach = static_cast<std::size_t>(clip_radius);
  std::vector<std::uint16_t> padded(width + 2 * reach + kMargin, kFar);
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* column = columns.data() + static_cast<std::size_t>(y) * width;
    std::uint16_t* o = out + static_cast<std::ptrdiff_t>(y) * out_stride;
    if (std::all_of(column, column + width, [far](std::uint8_t v) { return v == far; })) {
      std::fill(o, o + width, kFar);
      continue;
    }
    for (std::size_t x = 0; x < width; ++x) padded[reach + x] = squares[column[x]];
    HWY_DYNAMIC_DISPATCH(EnvelopeRow)(padded.data() + reach, clip_radius, width, o);
  }
}

}  // namespace sextant
#endif  // HWY_ONCE
