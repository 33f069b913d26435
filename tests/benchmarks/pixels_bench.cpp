// SPDX-License-Identifier: Apache-2.0
// What the hardware layer adds to a frame between the driver's buffer and pairing: decoding of 640 x 480. The
// baseline is a plain copy of the same bytes.
#include <benchmark/benchmark.h>

#include <cstring>
#include <random>
#include <vector>

#include "hal/pixels/decode.h"

namespace sextant {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

struct Image {
  explicit Image(PixelFormat format) : bytes(static_cast<std::size_t>(kWidth) * kHeight * 2) {
    std::mt19937 random(1);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
    raw.format = format;
    raw.width = kWidth;
    raw.height = kHeight;
    raw.stride = static_cast<std::size_t>(kWidth) * 2;
    raw.bytes = bytes;
  }
  std::vector<std::byte> bytes;
  RawImage raw;
};

void bm_copy_of_a_raw_image(benchmark::State& state) {
  const Image image(PixelFormat::kYuyv);
  std::vector<std::byte> out(image.bytes.size());
  for (auto _ : state) {
    std::memcpy(out.data(), image.bytes.data(), out.size());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(bm_copy_of_a_raw_image)->Unit(benchmark::kMillisecond);

void bm_decode_yuyv(benchmark::State& state) {
  const Image image(PixelFormat::kYuyv);
  for (auto _ : state) benchmark::DoNotOptimize(decode_colour(image.raw, "bench"));
}
BENCHMARK(bm_decode_yuyv)->Unit(benchmark::kMillisecond);

void bm_decode_z16(benchmark::State& state) {
  const Image image(PixelFormat::kZ16);
  for (auto _ : state) benchmark::DoNotOptimize(decode_depth(image.raw, {}, "bench"));
}
BENCHMARK(bm_decode_z16)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant
