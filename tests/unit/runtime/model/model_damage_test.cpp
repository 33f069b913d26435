// SPDX-License-Identifier: Apache-2.0
// Damaged, truncated and hostile files: each is refused with a reason, or it is a sound model after all.
#include <flatbuffers/flatbuffers.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include <cstring>
#include <random>

#include "idl/model/object_model_generated.h"
#include "runtime/base/error.h"
#include "runtime/model/model_check.h"
#include "runtime/model/model_file.h"
#include "synthetic_model.h"

namespace sextant {
namespace {

using Bytes = std::vector<std::byte>;
constexpr std::size_t kHeaderBytes = sizeof(fbs::FileHeader);

/// Makes size and checksum of the header fit, so that the deeper checks are reached.
void seal(Bytes& bytes) {
  const std::uint64_t size = bytes.size() - kHeaderBytes;
  const std::uint64_t checksum = XXH3_64bits(bytes.data() + kHeaderBytes, size);
  std::memcpy(bytes.data() + 8, &size, 8);
  std::memcpy(bytes.data() + 16, &checksum, 8);
}

std::string refusal(const Bytes& bytes) {
  try {
    decode_model(bytes, "some.sxm");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(DamagedModel, EveryFlippedByteIsRefused) {
  const Bytes sound = encode_model(test::make_box_model(1, 3, 1));
  ASSERT_EQ(refusal(sound), "");
  for (std::size_t i = 0; i < sound.size(); ++i) {
    for (const unsigned flip : {0x01U, 0x80U, 0xffU}) {
      Bytes damaged = sound;
      damaged[i] ^= static_cast<std::byte>(flip);
      ASSERT_THAT(refusal(damaged), testing::StartsWith("some.sxm: ")) << "byte " << i;
    }
  }
}

TEST(DamagedModel, EveryTruncationIsRefused) {
  const Bytes sound = encode_model(test::make_box_model(1, 3, 1));
  for (std::size_t size = 0; size < sound.size(); ++size) {
    ASSERT_NE(refusal(Bytes(sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(size))), "") << size;
  }
  Bytes longer = sound;
  longer.push_back(std::byte{0});
  EXPECT_THAT(refusal(longer), testing::HasSubstr("behind its end"));
}

TEST(DamagedModel, AnotherVersionSaysWhatToDo) {
  Bytes bytes = encode_model(test::make_box_model(1, 3, 1));
  bytes[4] = std::byte{kModelFormatVersion + 1};
  EXPECT_THAT(refusal(bytes),
              testing::HasSubstr("format version " + std::to_string(kModelFormatVersion + 1) +
                                 ", this program reads version " + std::to_string(kModelFormatVersion)));
  EXPECT_THAT(refusal(bytes), testing::EndsWith("compile the mesh again with this version"));
}

TEST(DamagedModel, AnotherIdentifierIsNotAModel) {
  Bytes bytes = encode_model(test::make_box_model(1, 3, 1));
  bytes[0] = std::byte{'P'};
  EXPECT_THAT(refusal(bytes), testing::HasSubstr("is not a compiled model"));
  bytes[0] = std::byte{'S'};
  bytes[kHeaderBytes + 4] = std::byte{'P'};  // the FlatBuffer's own identifier
  seal(bytes);
  EXPECT_THAT(refusal(bytes), testing::HasSubstr("structure is broken"));
}

/// What must hold of anything that the reader accepts.
void expect_sound(const ObjectModel& model) {
  check_model(model, "accepted", "");
  const Bytes once = encode_model(model);
  EXPECT_EQ(encode_model(decode_model(once, "again")), once);
}

TEST(HostileModel, SealedTruncationsAreRefusedOrSound) {
  const Bytes whole = encode_model(test::make_box_model(1, 3, 1));
  std::size_t refused = 0;
  for (std::size_t size = kHeaderBytes; size < whole.size(); ++size) {
    Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    seal(cut);
    try {
      expect_sound(decode_model(cut, "cut"));  // only padding was cut
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused + 8, whole.size() - kHeaderBytes);
}

TEST(HostileModel, MutationsAreRefusedOrSound) {
  const Bytes small = encode_model(test::make_box_model(1, 3, 1));
  const Bytes other = encode_model(test::make_random_model(2, 2, 0.1, 4));
  std::mt19937_64 random(11);
  int accepted = 0;
  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    Bytes bytes = (round & 1) != 0 ? small : other;
    const std::size_t payload = bytes.size() - kHeaderBytes;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int k = 0; k < changes; ++k) {
      const std::size_t at = kHeaderBytes + random() % payload;
      switch (random() % 4) {
        case 0:
          bytes[at] = static_cast<std::byte>(random());
          break;
        case 1:
          bytes[at] ^= static_cast<std::byte>(1U << (random() % 8));
          break;
        case 2: {  // a whole word: an offset, a length, two coefficients
          const std::size_t word = kHeaderBytes + (at - kHeaderBytes) / 4 * 4;
          const std::array<std::uint32_t, 6> tempting{
              0, 1, 0x7fffffff, 0x80000000, 0xffffffff, static_cast<std::uint32_t>(random() % payload)};
          const std::uint32_t value = tempting[random() % tempting.size()];
          std::memcpy(&bytes[word], &value, std::min<std::size_t>(4, bytes.size() - word));
          break;
        }
        default: {  // a piece of the file over another piece
          const std::size_t from = kHeaderBytes + random() % payload;
          const std::size_t room = bytes.size() - std::max(at, from);
          std::memmove(&bytes[at], &bytes[from], std::min<std::size_t>(random() % 64, room));
        }
      }
    }
    seal(bytes);
    try {
      expect_sound(decode_model(bytes, "mutated"));
      ++accepted;
    } catch (const InputError&) {
      ++refused;
    }
  }
  // Both paths were walked: many mutations only change a coefficient, many break something.
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 5000);
}

/// A model whose bins all name the same arrays: 100 kB that would grow to gigabytes in memory.
TEST(HostileModel, SharedArraysDoNotFillTheMemory) {
  flatbuffers::FlatBufferBuilder to;
  const std::size_t n = 4096;
  const std::vector<std::uint8_t> kinds(n);
  const std::vector<std::int16_t> forms(8 * n);
  const std::vector<std::int16_t> fewer(4 * n);
  const std::vector<std::int16_t> positions(2 * n);
  const std::vector<std::uint16_t> codes(n, 30000);
  const fbs::FormSteps steps(-20, -20, -20, -20);
  const auto seen = fbs::CreatePartStatisticsDirect(to, &codes, &kinds, &kinds, &codes);
  const auto visual = fbs::CreateVisualPartsDirect(to, &steps, &kinds, &forms, &codes, &codes, seen);
  const auto depth =
      fbs::CreateDepthPartsDirect(to, -20, &positions, &steps, &fewer, &codes, &codes, &codes, seen, &kinds);
  const std::array<std::int16_t, 3> lo{0, 0, 0};
  const std::array<std::int16_t, 3> hi{20, 20, 20};
  const fbs::Box box{flatbuffers::span<const std::int16_t, 3>(lo),
                     flatbuffers::span<const std::int16_t, 3>(hi)};
  const fbs::Extent extent(-1, -1, 1, 1);
  const std::vector<flatbuffers::Offset<fbs::Bin>> bins(kMaxModelBins,
                                                        fbs::CreateBin(to, &box, &extent, visual, depth));
  const std::vector<std::int16_t> vertices;
  const std::vector<std::uint16_t> triangles;
  const auto mesh = fbs::CreateMeshDirect(to, -20, &vertices, &triangles);
  const auto provenance = fbs::CreateProvenanceDirect(to, "", "", 0, 0, "");
  const std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::array<double, 3> translation{};
  const fbs::Transform transform{flatbuffers::span<const double, 9>(rotation),
                                 flatbuffers::span<const double, 3>(translation)};
  const auto build = [&](const std::vector<flatbuffers::Offset<fbs::Bin>>& which) {
    fbs::FinishModelBuffer(
        to, fbs::CreateModelDirect(to, "bomb", 1, 0, 0, 0.1, 0.1, &transform, &which, mesh, provenance));
    Bytes bytes(kHeaderBytes + to.GetSize());
    const std::uint32_t version = kModelFormatVersion;
    std::memcpy(bytes.data(), "SXTM", 4);
    std::memcpy(bytes.data() + 4, &version, 4);
    std::memcpy(bytes.data() + kHeaderBytes, to.GetBufferPointer(), to.GetSize());
    seal(bytes);
    return bytes;
  };
  const Bytes bytes = build(bins);
  EXPECT_LT(bytes.size(), 300000U);
  EXPECT_THAT(refusal(bytes), testing::HasSubstr("arrays overlap"));
}

}  // namespace
}  // namespace sextant
