// SPDX-License-Identifier: Apache-2.0
// Proofs survive being written, and damaged ones are refused in one line.
#include "offline/proof/proof_file.h"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "offline/proof/fingerprint.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

Proof example() {
  Proof p;
  p.program = "sextant test";
  p.models = {{"a.sxm", "0123456789abcdef", "a"}, {"b.sxm", "fedcba9876543210", "b"}};
  p.source = {"data/sample", "test", "", "", ""};
  p.options.table = TableSource::kFixed;
  p.options.fixed_table = TableGeometry::from_pitch_roll(0.7, 0.1, 1.0 / 3);
  p.options.max_detections = 2;
  p.options.region = region_from_text("1.5 2 30 40", "-1 1 -2 2 0 0.1", "0.1 0.2 0.3 0.6 0 0 0.8");
  FrameProof f;
  f.scene_id = 1;
  f.image_id = 7;
  f.hash = "0011223344556677";
  f.table = p.options.fixed_table;
  f.objects.push_back(
      {0, 12.3, SearchStatus::kOptimal, 0.1 + 0.2, {{{3, {1, 2, 300, -4, -50, 60}}, 0.1 + 0.2}}, "01..."});
  f.objects.push_back({1, 12.3, SearchStatus::kAbsent, 12.3, {}, "..."});
  p.frames = {f, f};
  p.frames[1].table.reset();
  return p;
}

/// The text with another body and the checksum that fits it.
std::string sealed(nlohmann::ordered_json json) {
  json.erase("checksum");
  json["checksum"] =
      text_fingerprint(json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

TEST(ProofFile, IsReadBackBitForBit) {
  const std::string text = format_proof(example());
  const Proof p = parse_proof(text, "p");
  EXPECT_EQ(format_proof(p), text);
  EXPECT_EQ(p.frames[0].objects[0].found[0].score, 0.1 + 0.2);
  EXPECT_EQ(p.frames[0].objects[0].found[0].pose, (LatticePose{3, {1, 2, 300, -4, -50, 60}}));
  EXPECT_EQ(p.frames[0].table->camera_height_m, 1.0 / 3);
  EXPECT_FALSE(p.frames[1].table);
  EXPECT_TRUE(p.options.region == example().options.region);
  EXPECT_EQ(p.frames[0].objects[1].status, SearchStatus::kAbsent);
}

TEST(ProofFile, EveryChangedByteIsNoticed) {
  const std::string text = format_proof(example());
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    for (const int change : {1, 0x20, 0x80}) {
      std::string damaged = text;
      damaged[i] = static_cast<char>(damaged[i] ^ change);
      try {
        // The same numbers in other words are the same proof.
        EXPECT_EQ(format_proof(parse_proof(damaged, "p")), text) << i;
      } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      }
    }
    EXPECT_THROW(parse_proof(text.substr(0, i), "p"), InputError);
  }
}

/// Every value of a JSON tree, by visiting references.
void for_each_value(nlohmann::ordered_json& json, const std::function<void(nlohmann::ordered_json&)>& visit) {
  visit(json);
  if (json.is_structured()) {
    for (auto& child : json) for_each_value(child, visit);
  }
}

TEST(ProofFile, AnySealedNonsenseIsRefusedOrRead) {
  using Json = nlohmann::ordered_json;
  const Json whole = Json::parse(format_proof(example()));
  const std::vector<Json> nonsense{nullptr,
                                   true,
                                   -1,
                                   1e300,
                                   1e-300,
                                   0,
                                   std::uint64_t{1} << 63U,
                                   "x",
                                   "\xff",
                                   Json::array(),
                                   Json::object(),
                                   Json::array({1, "a", nullptr})};
  std::size_t values = 0;
  Json counted = whole;
  for_each_value(counted, [&](Json&) { ++values; });
  int refused = 0;
  for (std::size_t at = 1; at < values; ++at) {
    for (const Json& what : nonsense) {
      Json changed = whole;
      std::size_t i = 0;
      Json* target = nullptr;
      for_each_value(changed, [&](Json& v) {
        if (i++ == at) target = &v;
      });
      *target = what;
      try {
        parse_proof(sealed(changed), "p");
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 500);
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    std::string text = format_proof(example());
    for (int i = 0; i < 4; ++i) text[random() % text.size()] = static_cast<char>(random());
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) continue;
    try {
      parse_proof(sealed(json), "p");
    } catch (const InputError&) {
    }
  }
}

TEST(ProofFile, DeepNestingIsNoProblem) {
  EXPECT_THROW(parse_proof(std::string(200000, '['), "p"), InputError);
  const std::string text = format_proof(example());
  const std::string deep = std::string(200000, '[') + std::string(200000, ']');
  EXPECT_THROW(parse_proof("{\"a\":" + deep + "," + text.substr(1), "p"), InputError);
}

}  // namespace
}  // namespace sextant
