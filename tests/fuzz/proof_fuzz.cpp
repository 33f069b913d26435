// SPDX-License-Identifier: Apache-2.0
// Fuzzes the reader of proofs and the check of their boxes. The mutator changes values of a real proof and
// makes the checksum fit again; what is read must be written and read again as it was, and no text is a tree
// of boxes that costs more than its length.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "offline/proof/fingerprint.h"
#include "offline/proof/proof_file.h"
#include "offline/proof/split_tree.h"
#include "runtime/base/error.h"
#include "small_space.h"

namespace {

using Json = nlohmann::ordered_json;

const std::string& seed_proof() {
  static const std::string kText = [] {
    sextant::Proof p;
    p.program = "sextant";
    p.models = {{"a.sxm", "0123456789abcdef", "a"}, {"b.sxm", "fedcba9876543210", "b"}};
    p.source = {"data/sample", "test", "", "", ""};
    p.options.table = sextant::TableSource::kFixed;
    p.options.fixed_table = sextant::TableGeometry::from_pitch_roll(0.7, 0.1, 0.7);
    p.options.max_detections = 2;
    p.options.region = sextant::region_from_text("1 2 30 40", "-1 1 -2 2 0 0.1", "0.1 0.2 0.3 0.6 0 0 0.8");
    sextant::FrameProof f;
    f.hash = "0011223344556677";
    f.table = p.options.fixed_table;
    f.objects.push_back(
        {0, 12.3, sextant::SearchStatus::kOptimal, 0.3, {{{3, {1, 2, 300, -4, -50, 60}}, 0.3}}, "0.1.2...."});
    f.objects.push_back({1, 12.3, sextant::SearchStatus::kAbsent, 12.3, {}, "5..."});
    p.frames = {f};
    return sextant::format_proof(p);
  }();
  return kText;
}

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string sealed(Json json) {
  if (!json.is_object()) return dumped(json);
  json.erase("checksum");
  json["checksum"] = sextant::text_fingerprint(dumped(json));
  return dumped(json);
}

void collect(Json& json, std::vector<Json*>& out) {
  out.push_back(&json);
  if (!json.is_structured()) return;
  for (Json& child : json) collect(child, out);
}

void require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "accepted a proof, but %s\n", what);
  std::abort();
}

}  // namespace

// Names and signatures are libFuzzer's.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

Json other_value(const Json& old, std::mt19937& random) {
  const auto any = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  if (old.is_string() && any(4) != 0) {
    std::string text = old.get<std::string>();
    const std::size_t used = text.size();
    text.resize(used + 64);
    const std::size_t size =
        LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(text.data()), used, text.size());
    text.resize(size);
    return text;
  }
  if (old.is_number() && any(4) != 0) {
    double value = old.get<double>();
    LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(&value), sizeof value, sizeof value);
    if (old.is_number_integer()) return static_cast<std::int64_t>(any(3)) - 1;
    return value;
  }
  switch (any(6)) {
    case 0:
      return nullptr;
    case 1:
      return Json::array();
    case 2:
      return Json::object();
    case 3:
      return std::uint64_t{1} << any(64);
    case 4:
      return -1e300;
    default:
      return true;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  std::mt19937 random(seed);
  if (seed % 16 == 0) return LLVMFuzzerMutate(data, size, max_size);  // no JSON any more, mostly
  Json json = Json::parse(std::string(reinterpret_cast<const char*>(data), size), nullptr, false);
  if (json.is_discarded() || !json.is_object() || size > 8192) json = Json::parse(seed_proof());
  for (unsigned changes = 1 + seed % 3; changes > 0; --changes) {
    std::vector<Json*> values;
    collect(json, values);
    Json* changed = values[std::uniform_int_distribution<std::size_t>(0, values.size() - 1)(random)];
    if (changed->is_array() && !changed->empty() && changed->size() < 20 && random() % 2 == 0) {
      changed->push_back(changed->front());
    } else if (changed != &json) {
      *changed = other_value(*changed, random);
    }
  }
  const std::string text = sealed(json);
  if (text.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, text.data(), text.size());
  return text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const sextant::SmallSpace kSpace(1, 8, 6, 0.9, 0.91);
  sextant::Proof proof;
  try {
    proof = sextant::parse_proof(std::string(reinterpret_cast<const char*>(data), size), "fuzz");
  } catch (const sextant::InputError& e) {
    require(std::strchr(e.what(), '\n') == nullptr, "refused it in more than one line");
    return 0;
  }
  const std::string once = sextant::format_proof(proof);
  require(sextant::format_proof(sextant::parse_proof(once, "again")) == once, "its text is not stable");
  const sextant::SearchProblem problem = kSpace.search();
  const sextant::Claim nothing_there(problem, {}, 1, 1e9);
  for (const sextant::FrameProof& frame : proof.frames) {
    for (const sextant::ObjectProof& object : frame.objects) {
      const sextant::TreeCheck check = sextant::check_split_tree(problem, nothing_there, object.tree);
      require(check.boxes <= object.tree.size(), "it has more boxes than characters");
    }
  }
  return 0;
}
