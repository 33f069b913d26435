// SPDX-License-Identifier: Apache-2.0
// Fuzzes the model file's reader. The mutator works behind the header and makes the checksum fit again, so
// that the structure and the ranges are attacked and not only XXH3; it starts from real models, so no corpus
// is needed.
#include <xxhash.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "idl/model/object_model_generated.h"
#include "runtime/base/error.h"
#include "runtime/model/model_check.h"
#include "runtime/model/model_file.h"
#include "synthetic_model.h"

namespace {

constexpr std::size_t kHeaderBytes = sizeof(sextant::fbs::FileHeader);

const std::vector<std::byte>& seed_model(unsigned which) {
  static const std::array<std::vector<std::byte>, 3> kModels{
      sextant::encode_model(sextant::test::make_box_model(1, 2, 1)),
      sextant::encode_model(sextant::test::make_random_model(1, 1, 0.1, 2)),
      sextant::encode_model(sextant::test::make_random_model(3, 4, 0.3, 3))};
  return kModels[which % kModels.size()];
}

void seal(std::uint8_t* data, std::size_t size) {
  const std::uint64_t payload = size - kHeaderBytes;
  const std::uint64_t checksum = XXH3_64bits(data + kHeaderBytes, payload);
  std::memcpy(data + 8, &payload, 8);
  std::memcpy(data + 16, &checksum, 8);
}

void require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "accepted a model, but %s\n", what);
  std::abort();
}

}  // namespace

// Names and signatures are libFuzzer's.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  const std::vector<std::byte>& model = seed_model(seed >> 8U);
  if (max_size < model.size()) return LLVMFuzzerMutate(data, size, max_size);
  if (size <= kHeaderBytes || std::memcmp(data, model.data(), 8) != 0) {
    std::memcpy(data, model.data(), model.size());
    size = model.size();
  }
  if (seed % 16 == 0) return LLVMFuzzerMutate(data, size, max_size);  // the header too, and no new checksum
  size = kHeaderBytes + LLVMFuzzerMutate(data + kHeaderBytes, size - kHeaderBytes, max_size - kHeaderBytes);
  seal(data, size);
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  sextant::ObjectModel model;
  try {
    model = sextant::decode_model(bytes, "fuzz");
  } catch (const sextant::InputError&) {
    return 0;
  }
  // Whatever is accepted is sound and can be stored; storing rounds only once.
  sextant::check_model(model, "accepted", "");
  const std::vector<std::byte> once = sextant::encode_model(model);
  require(sextant::encode_model(sextant::decode_model(once, "again")) == once, "its encoding is not stable");
  return 0;
}
