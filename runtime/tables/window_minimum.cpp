// SPDX-License-Identifier: Apache-2.0
#include "runtime/tables/window_minimum.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/tables/window_minimum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sextant {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// out[i] = fold(a[i], b[i], c[i], d[i]), vectors first, then the rest one by one.
template <typename T, typename VectorFold, typename ScalarFold>
void fold4(const T* a, const T* b, const T* c, const T* d, T* out, std::size_t count, VectorFold vector,
           ScalarFold scalar) {
  const hn::ScalableTag<T> tag;
  const std::size_t lanes = hn::Lanes(tag);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto left = vector(hn::LoadU(tag, a + i), hn::LoadU(tag, b + i));
    const auto right = vector(hn::LoadU(tag, c + i), hn::LoadU(tag, d + i));
    hn::StoreU(vector(left, right), tag, out + i);
  }
  for (; i < count; ++i) out[i] = scalar(scalar(a[i], b[i]), scalar(c[i], d[i]));
}

void FoldSmallestU8(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                    const std::uint8_t* d, std::uint8_t* out, std::size_t count) {
  fold4(
      a, b, c, d, out, count, [](auto x, auto y) HWY_ATTR { return hn::Min(x, y); },
      [](std::uint8_t x, std::uint8_t y) { return std::min(x, y); });
}

void FoldNearestU16(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                    const std::uint16_t* d, std::uint16_t* out, std::size_t count) {
  const hn::ScalableTag<std::uint16_t> tag;
  const auto one = hn::Set(tag, std::uint16_t{1});
  fold4(
      a, b, c, d, out, count,
      [&](auto x, auto y) HWY_ATTR { return hn::Or(hn::Min(x, y), hn::And(hn::Or(x, y), one)); },
      [](std::uint16_t x, std::uint16_t y) {
        return static_cast<std::uint16_t>(std::min(x, y) | ((x | y) & 1U));
      });
}

void FoldLargestU16(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                    const std::uint16_t* d, std::uint16_t* out, std::size_t count) {
  fold4(
      a, b, c, d, out, count, [](auto x, auto y) HWY_ATTR { return hn::Max(x, y); },
      [](std::uint16_t x, std::uint16_t y) { return std::max(x, y); });
}

/// Half resolution: two rows folded, then the two halves of every pair. T2: twice as wide as T.
template <typename T, typename T2, typename VectorFold, typename ScalarFold>
void halve(const T* a, const T* b, T* out, std::size_t count, [[maybe_unused]] VectorFold vector,
           ScalarFold scalar) {
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<T2> wide;
  const hn::Repartition<T, decltype(wide)> narrow;
  const hn::Rebind<T, decltype(wide)> half;
  const std::size_t lanes = hn::Lanes(wide);
  const auto mask = hn::Set(wide, static_cast<T2>(static_cast<T>(~T{0})));
  for (; i + lanes <= count; i += lanes) {
    const auto rows = vector(hn::LoadU(narrow, a + 2 * i), hn::LoadU(narrow, b + 2 * i));
    const auto pairs = hn::BitCast(wide, rows);
    const auto first = hn::And(pairs, mask);
    const auto second = hn::ShiftRight<8 * sizeof(T)>(pairs);
    const auto folded = hn::BitCast(wide, vector(hn::BitCast(narrow, first), hn::BitCast(narrow, second)));
    hn::StoreU(hn::TruncateTo(half, folded), half, out + i);
  }
#endif
  for (; i < count; ++i) out[i] = scalar(scalar(a[2 * i], a[2 * i + 1]), scalar(b[2 * i], b[2 * i + 1]));
}

void HalveSmallestU8(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* out, std::size_t count) {
  halve<std::uint8_t, std::uint16_t>(
      a, b, out, count, [](auto x, auto y) HWY_ATTR { return hn::Min(x, y); },
      [](std::uint8_t x, std::uint8_t y) { return std::min(x, y); });
}
void HalveNearestU16(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out, std::size_t count) {
  const hn::ScalableTag<std::uint16_t> tag;
  const auto one = hn::Set(tag, std::uint16_t{1});
  halve<std::uint16_t, std::uint32_t>(
      a, b, out, count,
      [&](auto x, auto y) HWY_ATTR { return hn::Or(hn::Min(x, y), hn::And(hn::Or(x, y), one)); },
      [](std::uint16_t x, std::uint16_t y) {
        return static_cast<std::uint16_t>(std::min(x, y) | ((x | y) & 1U));
      });
}
void HalveLargestU16(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out, std::size_t count) {
  halve<std::uint16_t, std::uint32_t>(
      a, b, out, count, [](auto x, auto y) HWY_ATTR { return hn::Max(x, y); },
      [](std::uint16_t x, std::uint16_t y) { return std::max(x, y); });
}

template <typename T>
void split(const T* row, std::size_t phases, std::size_t count, T* const* out) {
  if (phases == 1) {
    std::copy(row, row + count, out[0]);
    return;
  }
  std::size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  auto v0 = hn::Zero(d);
  auto v1 = v0;
  auto v2 = v0;
  auto v3 = v0;
  if (phases == 2) {
    for (; i + lanes <= count; i += lanes) {
      hn::LoadInterleaved2(d, row + 2 * i, v0, v1);
      hn::StoreU(v0, d, out[0] + i);
      hn::StoreU(v1, d, out[1] + i);
    }
  } else {
    for (; i + lanes <= count; i += lanes) {
      hn::LoadInterleaved4(d, row + 4 * i, v0, v1, v2, v3);
      hn::StoreU(v0, d, out[0] + i);
      hn::StoreU(v1, d, out[1] + i);
      hn::StoreU(v2, d, out[2] + i);
      hn::StoreU(v3, d, out[3] + i);
    }
  }
#endif
  for (; i < count; ++i) {
    for (std::size_t p = 0; p < phases; ++p) out[p][i] = row[i * phases + p];
  }
}
void SplitPhasesU8(const std::uint8_t* row, std::size_t phases, std::size_t count, std::uint8_t* const* out) {
  split(row, phases, count, out);
}
void SplitPhasesU16(const std::uint16_t* row, std::size_t phases, std::size_t count,
                    std::uint16_t* const* out) {
  split(row, phases, count, out);
}

void FlagMissingU16(const std::uint16_t* depth, std::uint16_t* out, std::size_t count) {
  const hn::ScalableTag<std::uint16_t> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto missing = hn::Set(d, std::uint16_t{65535});
  const auto even = hn::Set(d, std::uint16_t{65534});
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto v = hn::LoadU(d, depth + i);
    hn::StoreU(hn::IfThenElse(hn::Eq(v, missing), v, hn::And(v, even)), d, out + i);
  }
  for (; i < count; ++i)
    out[i] = depth[i] == 65535 ? depth[i] : static_cast<std::uint16_t>(depth[i] & 65534U);
}

void DistanceCodes(const std::uint16_t* distance2, int scale, std::uint8_t* out, std::size_t count) {
  const hn::ScalableTag<float> df;
  const hn::Rebind<std::uint16_t, decltype(df)> d16;
  const hn::Rebind<std::int32_t, decltype(df)> d32;
  const hn::Rebind<std::uint8_t, decltype(df)> d8;
  const auto factor = hn::Set(df, static_cast<float>(scale));
  const std::size_t lanes = hn::Lanes(df);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    const auto wide = hn::PromoteTo(d32, hn::LoadU(d16, distance2 + i));
    const auto code = hn::ConvertTo(d32, hn::Mul(hn::Sqrt(hn::ConvertTo(df, wide)), factor));
    hn::StoreU(hn::DemoteTo(d8, code), d8, out + i);
  }
  for (; i < count; ++i) {
    const float code = std::sqrt(static_cast<float>(distance2[i])) * static_cast<float>(scale);
    out[i] = static_cast<std::uint8_t>(std::min(code, 255.0F));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace sextant
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sextant {

HWY_EXPORT(FoldSmallestU8);
HWY_EXPORT(FoldNearestU16);
HWY_EXPORT(FoldLargestU16);
HWY_EXPORT(HalveSmallestU8);
HWY_EXPORT(HalveNearestU16);
HWY_EXPORT(HalveLargestU16);
HWY_EXPORT(SplitPhasesU8);
HWY_EXPORT(SplitPhasesU16);
HWY_EXPORT(FlagMissingU16);
HWY_EXPORT(DistanceCodes);

void fold_smallest_u8(const std::uint8_t* a, const std::uint8_t* b, const std::uint8_t* c,
                      const std::uint8_t* d, std::uint8_t* out, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FoldSmallestU8)(a, b, c, d, out, count);
}
void fold_nearest_u16(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                      const std::uint16_t* d, std::uint16_t* out, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FoldNearestU16)(a, b, c, d, out, count);
}
void fold_largest_u16(const std::uint16_t* a, const std::uint16_t* b, const std::uint16_t* c,
                      const std::uint16_t* d, std::uint16_t* out, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FoldLargestU16)(a, b, c, d, out, count);
}
void halve_smallest_u8(const std::uint8_t* a, const std::uint8_t* b, std::uint8_t* out, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(HalveSmallestU8)(a, b, out, count);
}
void halve_nearest_u16(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out,
                       std::size_t count) {
  HWY_DYNAMIC_DISPATCH(HalveNearestU16)(a, b, out, count);
}
void halve_largest_u16(const std::uint16_t* a, const std::uint16_t* b, std::uint16_t* out,
                       std::size_t count) {
  HWY_DYNAMIC_DISPATCH(HalveLargestU16)(a, b, out, count);
}
void split_phases_u8(const std::uint8_t* row, std::size_t phases, std::size_t count,
                     std::uint8_t* const* out) {
  HWY_DYNAMIC_DISPATCH(SplitPhasesU8)(row, phases, count, out);
}
void split_phases_u16(const std::uint16_t* row, std::size_t phases, std::size_t count,
                      std::uint16_t* const* out) {
  HWY_DYNAMIC_DISPATCH(SplitPhasesU16)(row, phases, count, out);
}
void flag_missing_u16(const std::uint16_t* depth, std::uint16_t* out, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FlagMissingU16)(depth, out, count);
}
void distance_codes(const std::uint16_t* distance2, int scale, std::uint8_t* out, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(DistanceCodes)(distance2, scale, out, count);
}

}  // namespace sextant
#endif  // HWY_ONCE
