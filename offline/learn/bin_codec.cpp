// SPDX-License-Identifier: Apache-2.0
#include "offline/learn/bin_codec.h"

#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace sextant {
namespace {

static_assert(std::is_trivially_copyable_v<VisualPart> && std::is_trivially_copyable_v<DepthPart> &&
              std::is_trivially_copyable_v<RotationBox>);

template <typename T>
void put(std::vector<std::byte>& out, const T* values, std::size_t count) {
  const auto* bytes = reinterpret_cast<const std::byte*>(values);
  out.insert(out.end(), bytes, bytes + count * sizeof(T));
}

template <typename T>
void take(std::span<const std::byte>& in, T* values, std::size_t count) {
  if (in.size() / sizeof(T) < count) throw std::runtime_error("a learnt bin arrived incomplete");
  if (count > 0) std::memcpy(values, in.data(), count * sizeof(T));
  in = in.subspan(count * sizeof(T));
}

}  // namespace

std::vector<std::byte> encode_bin(const ViewpointBin& bin) {
  std::vector<std::byte> out;
  const std::uint64_t counts[2] = {bin.visual.size(), bin.depth.size()};
  put(out, &bin.box, 1);
  put(out, bin.extent.data(), bin.extent.size());
  put(out, counts, 2);
  put(out, bin.visual.data(), bin.visual.size());
  put(out, bin.depth.data(), bin.depth.size());
  return out;
}

ViewpointBin decode_bin(std::span<const std::byte> bytes) {
  ViewpointBin bin;
  std::uint64_t counts[2] = {};
  take(bytes, &bin.box, 1);
  take(bytes, bin.extent.data(), bin.extent.size());
  take(bytes, counts, 2);
  if (counts[0] > bytes.size() / sizeof(VisualPart) || counts[1] > bytes.size() / sizeof(DepthPart)) {
    throw std::runtime_error("a learnt bin arrived incomplete");
  }
  bin.visual.resize(counts[0]);
  bin.depth.resize(counts[1]);
  take(bytes, bin.visual.data(), bin.visual.size());
  take(bytes, bin.depth.data(), bin.depth.size());
  if (!bytes.empty()) throw std::runtime_error("a learnt bin arrived with more than it should have");
  return bin;
}

}  // namespace sextant
