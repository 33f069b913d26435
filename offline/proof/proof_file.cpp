// SPDX-License-Identifier: Apache-2.0
#include "offline/proof/proof_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "offline/proof/fingerprint.h"
#include "runtime/base/error.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTableNames[] = {"none", "file", "estimate", "fixed"};

Json table_json(const TableGeometry& t) {
  return {{"up_in_camera", {t.up_in_camera.x(), t.up_in_camera.y(), t.up_in_camera.z()}},
          {"camera_height_m", t.camera_height_m}};
}

Json object_json(const ObjectProof& o) {
  Json found = Json::array();
  for (const ScoredPose& f : o.found) {
    found.push_back({{"bin", f.pose.bin}, {"at", f.pose.at}, {"score", f.score}});
  }
  return {{"model", o.model},         {"status", to_string(o.status)},
          {"threshold", o.threshold}, {"upper_bound", o.upper_bound},
          {"detections", found},      {"boxes", o.tree}};
}

/// Values of a JSON object that must be there, with where they are for the message.
class Reader {
 public:
  Reader(const Json& json, const std::string& file, std::string where)
      : json_(json), file_(file), where_(std::move(where)) {
    if (!json.is_object()) fail("is no object");
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(file_, where_ + " " + what, "write it again with `sextant detect --proof`");
  }
  const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(fmt::format("has no \"{}\"", key));
    return *found;
  }
  bool has(const char* key) const { return json_.contains(key) && !json_.at(key).is_null(); }
  Reader object(const char* key) const { return {at(key), file_, where_ + "." + key}; }
  std::vector<Reader> objects(const char* key, std::size_t most) const {
    const Json& array = at(key);
    if (!array.is_array() || array.size() > most) fail(fmt::format("has no sound list \"{}\"", key));
    std::vector<Reader> out;
    for (std::size_t i = 0; i < array.size(); ++i) {
      out.emplace_back(array[i], file_, fmt::format("{}.{}[{}]", where_, key, i));
    }
    return out;
  }
  std::string text(const char* key, std::size_t most = 4096) const {
    const Json& v = at(key);
    if (!v.is_string() || v.get_ref<const std::string&>().size() > most) {
      fail(fmt::format("has no sound text \"{}\"", key));
    }
    return v.get<std::string>();
  }
  double number(const char* key, double lo, double hi) const {
    const Json& v = at(key);
    if (!v.is_number()) fail(fmt::format("has no number \"{}\"", key));
    const auto d = v.get<double>();
    if (!(d >= lo && d <= hi)) fail(fmt::format("has \"{}\" outside of {}..{}", key, lo, hi));
    return d;
  }
  std::int64_t whole(const char* key, std::int64_t lo, std::int64_t hi) const {
    const Json& v = at(key);
    if (!v.is_number_integer()) fail(fmt::format("has no whole number \"{}\"", key));
    if (v.is_number_unsigned() && v.get<std::uint64_t>() > static_cast<std::uint64_t>(hi)) {
      fail(fmt::format("has too large a \"{}\"", key));
    }
    const auto n = v.get<std::int64_t>();
    if (n < lo || n > hi) fail(fmt::format("has \"{}\" outside of {}..{}", key, lo, hi));
    return n;
  }
  std::vector<double> numbers(const char* key, std::size_t count, double lo, double hi) const {
    const Json& v = at(key);
    if (!v.is_array() || v.size() != count) fail(fmt::format("has no {} numbers \"{}\"", count, key));
    std::vector<double> out;
    for (const Json& n : v) {
      if (!n.is_number() || !(n.get<double>() >= lo && n.get<double>() <= hi)) {
        fail(fmt::format("has a number outside of {}..{} in \"{}\"", lo, hi, key));
      }
      out.push_back(n.get<double>());
    }
    return out;
  }

 private:
  const Json& json_;
  const std::string& file_;
  std::string where_;
};

constexpr double kLargestScore = 1e12;
/// A proof nests less; what nests without end must not reach code that recurses.
constexpr int kMostDepth = 16;

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

TableGeometry read_table(const Reader& r) {
  TableGeometry t;
  const auto up = r.numbers("up_in_camera", 3, -1.001, 1.001);
  t.up_in_camera = {up[0], up[1], up[2]};
  if (std::abs(t.up_in_camera.norm() - 1) > 1e-3) r.fail("has an \"up_in_camera\" that is no direction");
  t.camera_height_m = r.number("camera_height_m", 0, 100);
  return t;
}

TableTolerance read_tolerance(const Reader& r) {
  return {r.number("height_m", 0, 100), r.number("angle_rad", 0, 4)};
}

SearchStatus read_status(const Reader& r) {
  const std::string name = r.text("status");
  for (const SearchStatus s : {SearchStatus::kOptimal, SearchStatus::kBounded, SearchStatus::kAbsent}) {
    if (name == to_string(s)) return s;
  }
  r.fail("has a \"status\" that is not optimal, bounded or absent");
}

ObjectProof read_object(const Reader& r, const Proof& proof) {
  ObjectProof o;
  o.model = static_cast<std::size_t>(r.whole("model", 0, static_cast<std::int64_t>(proof.models.size()) - 1));
  o.status = read_status(r);
  o.threshold = r.number("threshold", -kLargestScore, kLargestScore);
  o.upper_bound = r.number("upper_bound", -kLargestScore, kLargestScore);
  for (const Reader& f : r.objects("detections", static_cast<std::size_t>(proof.options.max_detections))) {
    ScoredPose pose;
    pose.pose.bin = static_cast<std::int32_t>(f.whole("bin", 0, 1000000));
    const auto at = f.numbers("at", kDimensions, -32768, 32767);
    for (std::size_t d = 0; d < kDimensions; ++d) {
      if (at[d] != std::floor(at[d])) f.fail("has an \"at\" that is no lattice pose");
      pose.pose.at[d] = static_cast<std::int16_t>(at[d]);
    }
    pose.score = f.number("score", -kLargestScore, kLargestScore);
    o.found.push_back(pose);
  }
  if ((o.status == SearchStatus::kAbsent && !o.found.empty()) ||
      (o.status == SearchStatus::kOptimal && o.found.empty())) {
    r.fail("has a \"status\" that contradicts its detections");
  }
  o.tree = r.text("boxes", kMostProofBytes);
  return o;
}

FrameProof read_frame(const Reader& r, const Proof& proof) {
  FrameProof f;
  constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();
  f.scene_id = r.whole("scene_id", 0, kLargest);
  f.image_id = r.whole("im_id", 0, kLargest);
  f.hash = r.text("hash", 16);
  if (r.has("table")) f.table = read_table(r.object("table"));
  f.tolerance = read_tolerance(r.object("tolerance"));
  for (const Reader& o : r.objects("objects", proof.models.size()))
    f.objects.push_back(read_object(o, proof));
  return f;
}

DetectOptions read_options(const Reader& r) {
  DetectOptions o;
  const std::string table = r.text("table");
  const auto* name = std::find(std::begin(kTableNames), std::end(kTableNames), table);
  if (name == std::end(kTableNames)) r.fail("has a \"table\" that is not none, file, estimate or fixed");
  o.table = static_cast<TableSource>(name - std::begin(kTableNames));
  if (o.table == TableSource::kFixed) o.fixed_table = read_table(r.object("fixed_table"));
  o.tolerance = read_tolerance(r.object("tolerance"));
  o.scoring = r.text("scoring", 100);
  o.max_detections = static_cast<int>(r.whole("max_detections", 1, 100));
  o.search_width = static_cast<int>(r.whole("search_width", 0, 4096));
  o.min_distance_m = r.number("min_distance_m", 0, 60);
  o.max_distance_m = r.number("max_distance_m", 0, 60);
  constexpr double kFarAway = 1e6;
  if (r.has("region")) {
    const auto n = r.numbers("region", 4, -kFarAway, kFarAway);
    std::copy(n.begin(), n.end(), o.region.image.emplace().begin());
  }
  if (r.has("workspace")) {
    const auto n = r.numbers("workspace", 6, -kFarAway, kFarAway);
    std::copy(n.begin(), n.end(), o.region.workspace.emplace().begin());
  }
  if (r.has("workspace_from_camera")) {
    const auto n = r.numbers("workspace_from_camera", 12, -kFarAway, kFarAway);
    RigidTransform& t = o.region.workspace_from_camera.emplace(RigidTransform::Identity());
    for (std::size_t i = 0; i < 12; ++i) t.matrix()(static_cast<int>(i / 4), static_cast<int>(i % 4)) = n[i];
  }
  return o;
}

Json body_json(const Proof& p) {
  Json models = Json::array();
  for (const ModelProof& m : p.models)
    models.push_back({{"file", m.file}, {"hash", m.hash}, {"name", m.name}});
  const DetectOptions& o = p.options;
  Json options = {{"table", kTableNames[static_cast<std::size_t>(o.table)]},
                  {"tolerance", {{"height_m", o.tolerance.height_m}, {"angle_rad", o.tolerance.angle_rad}}},
                  {"scoring", o.scoring},
                  {"max_detections", o.max_detections},
                  {"search_width", o.search_width},
                  {"min_distance_m", o.min_distance_m},
                  {"max_distance_m", o.max_distance_m}};
  if (o.table == TableSource::kFixed) options["fixed_table"] = table_json(o.fixed_table);
  if (o.region.image) options["region"] = *o.region.image;
  if (o.region.workspace) options["workspace"] = *o.region.workspace;
  if (o.region.workspace_from_camera) {
    const auto& m = o.region.workspace_from_camera->matrix();
    Json rows = Json::array();
    for (int i = 0; i < 12; ++i) rows.push_back(m(i / 4, i % 4));
    options["workspace_from_camera"] = rows;
  }
  Json frames = Json::array();
  for (const FrameProof& f : p.frames) {
    Json objects = Json::array();
    for (const ObjectProof& object : f.objects) objects.push_back(object_json(object));
    frames.push_back(
        {{"scene_id", f.scene_id},
         {"im_id", f.image_id},
         {"hash", f.hash},
         {"table", f.table ? table_json(*f.table) : Json(nullptr)},
         {"tolerance", {{"height_m", f.tolerance.height_m}, {"angle_rad", f.tolerance.angle_rad}}},
         {"objects", objects}});
  }
  return {{"sextant_proof", kProofVersion},
          {"program", p.program},
          {"models", models},
          {"source",
           {{"dataset", p.source.dataset},
            {"split", p.source.split},
            {"color", p.source.colour},
            {"depth", p.source.depth},
            {"camera", p.source.camera}}},
          {"options", options},
          {"frames", frames}};
}

}  // namespace

std::string format_proof(const Proof& proof) {
  Json json = body_json(proof);
  json["checksum"] = text_fingerprint(dumped(json));
  return dumped(json) + "\n";
}

Proof parse_proof(const std::string& text, const std::string& where) {
  bool deep = false;
  const auto not_deep = [&deep](int depth, Json::parse_event_t, Json&) {
    deep = deep || depth > kMostDepth;
    return !deep;
  };
  Json json = Json::parse(text, not_deep, false);
  if (json.is_discarded() || deep) {
    throw InputError(where, "is no JSON", "give a file that `sextant detect --proof` wrote");
  }
  const Reader r(json, where, "the proof");
  r.whole("sextant_proof", kProofVersion, kProofVersion);
  const std::string checksum = r.text("checksum", 16);
  json.erase("checksum");
  if (text_fingerprint(dumped(json)) != checksum) {
    throw InputError(where, "the proof was changed after it was written (its checksum does not fit)",
                     "write it again with `sextant detect --proof`");
  }
  Proof p;
  p.program = r.text("program");
  for (const Reader& m : r.objects("models", 1000)) {
    p.models.push_back({m.text("file"), m.text("hash", 16), m.text("name")});
  }
  if (p.models.empty()) r.fail("has no model");
  const Reader source = r.object("source");
  p.source = {source.text("dataset"), source.text("split"), source.text("color"), source.text("depth"),
              source.text("camera")};
  p.options = read_options(r.object("options"));
  for (const Reader& f : r.objects("frames", 10000000)) p.frames.push_back(read_frame(f, p));
  return p;
}

void write_proof(const std::filesystem::path& file, const Proof& proof) {
  std::ofstream out(file, std::ios::binary);
  out << format_proof(proof);
  out.close();
  if (!out) throw InputError(file.string(), std::strerror(errno), "choose another place for the proof");
}

Proof read_proof(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (!in || error) {
    throw InputError(file.string(), error ? error.message() : std::strerror(errno),
                     "give a file that `sextant detect --proof` wrote");
  }
  if (size > kMostProofBytes) throw InputError(file.string(), "is too large for a proof");
  std::ostringstream text;
  text << in.rdbuf();
  return parse_proof(text.str(), file.string());
}

}  // namespace sextant
