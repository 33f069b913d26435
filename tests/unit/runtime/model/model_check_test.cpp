// SPDX-License-Identifier: Apache-2.0
#include "runtime/model/model_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "runtime/base/error.h"
#include "synthetic_model.h"

namespace sextant {
namespace {

struct Fault {
  const char* said;
  std::function<void(ObjectModel&)> make;
};

class ModelCheckFault : public testing::TestWithParam<Fault> {};

TEST_P(ModelCheckFault, IsRefusedByName) {
  ObjectModel model = test::make_box_model(1, 3, 1);
  check_model(model, "box.sxm", "advice");
  GetParam().make(model);
  try {
    check_model(model, "box.sxm", "advice");
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().said));
    EXPECT_THAT(error.what(), testing::StartsWith("box.sxm: "));
    EXPECT_THAT(error.what(), testing::EndsWith("; advice"));
  }
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Every, ModelCheckFault,
    testing::Values(
        Fault{"no name", [](ObjectModel& m) { m.name.clear(); }},
        Fault{"control", [](ObjectModel& m) { m.name.append("\x1b[2J"); }},
        Fault{"slash", [](ObjectModel& m) { m.name.append("/../etc"); }},
        Fault{"too long", [](ObjectModel& m) { m.name.assign(300, 'a'); }},
        Fault{"slash", [](ObjectModel& m) { m.provenance.mesh_name.append("/b.ply"); }},
        Fault{"UTF-8", [](ObjectModel& m) { m.provenance.parameters.append("\xff"); }},
        Fault{"object id", [](ObjectModel& m) { m.object_id = -1; }},
        Fault{"symmetry", [](ObjectModel& m) { m.symmetry_deg = 45; }},
        Fault{"symmetry", [](ObjectModel& m) { m.geometric_symmetry_deg = -90; }},
        Fault{"radius", [](ObjectModel& m) { m.bounding_radius_m = 0; }},
        Fault{"radius", [](ObjectModel& m) { m.bounding_radius_m = NAN; }},
        Fault{"radius", [](ObjectModel& m) { m.bounding_radius_m = 100; }},
        Fault{"height", [](ObjectModel& m) { m.centre_height_m = -0.1; }},
        Fault{"not a rotation", [](ObjectModel& m) { m.object_from_mesh.linear() *= 1.001; }},
        Fault{"not a rotation", [](ObjectModel& m) { m.object_from_mesh.linear().col(0) *= -1; }},
        Fault{"finite", [](ObjectModel& m) { m.object_from_mesh.linear()(1, 1) = NAN; }},
        Fault{"1 km", [](ObjectModel& m) { m.object_from_mesh.translation().x() = 2000; }},
        Fault{"number of bins", [](ObjectModel& m) { m.bins.clear(); }},
        Fault{"number of bins", [](ObjectModel& m) { m.bins.resize(5001, m.bins[0]); }},
        Fault{"bin 1: the box", [](ObjectModel& m) { m.bins[1].box.hi_deg[2] = m.bins[1].box.lo_deg[2]; }},
        Fault{"bin 0: the box", [](ObjectModel& m) { m.bins[0].box.hi_deg[2] = 361; }},
        Fault{"bin 0: the box", [](ObjectModel& m) { m.bins[0].box.lo_deg[0] = -181; }},
        Fault{"4096", [](ObjectModel& m) { m.bins[0].visual.resize(4097, m.bins[0].visual[0]); }},
        Fault{"4096", [](ObjectModel& m) { m.bins[0].depth.resize(4097, m.bins[0].depth[0]); }},
        Fault{"no parts", [](ObjectModel& m) { m.bins[0].visual.clear(), m.bins[0].depth.clear(); }},
        Fault{"extent", [](ObjectModel& m) { m.bins[0].extent[2] = m.bins[0].extent[0] - 1; }},
        Fault{"extent", [](ObjectModel& m) { m.bins[0].extent[3] = kNan; }},
        Fault{"kind", [](ObjectModel& m) { m.bins[0].visual[2].kind = 8; }},
        Fault{"visual part's coefficient", [](ObjectModel& m) { m.bins[0].visual[1].u[0] = kNan; }},
        Fault{"visual part's coefficient", [](ObjectModel& m) { m.bins[0].visual[1].v[3] = kInfinity; }},
        Fault{"visual part's coefficient", [](ObjectModel& m) { m.bins[0].visual[1].v[2] = 100; }},
        Fault{"visual part's variance", [](ObjectModel& m) { m.bins[0].visual[0].variance = 0; }},
        Fault{"visual part's variance", [](ObjectModel& m) { m.bins[0].visual[0].variance = -1; }},
        Fault{"visual part's radius", [](ObjectModel& m) { m.bins[0].visual[0].radius = 0; }},
        Fault{"depth part's coefficient", [](ObjectModel& m) { m.bins[0].depth[0].px = kInfinity; }},
        Fault{"depth part's coefficient", [](ObjectModel& m) { m.bins[0].depth[0].py = 1000; }},
        Fault{"depth part's coefficient", [](ObjectModel& m) { m.bins[0].depth[0].d[3] = kNan; }},
        Fault{"depth part's variance", [](ObjectModel& m) { m.bins[0].depth[0].variance = kInfinity; }},
        Fault{"spread", [](ObjectModel& m) { m.bins[0].visual[0].seen.spread = -1; }},
        Fault{"share of found", [](ObjectModel& m) { m.bins[0].visual[0].seen.found = 1; }},
        Fault{"share of found", [](ObjectModel& m) { m.bins[0].depth[0].seen.background = 0; }},
        Fault{"weight", [](ObjectModel& m) { m.bins[0].depth[0].seen.weight = NAN; }},
        Fault{"role", [](ObjectModel& m) { m.bins[0].depth[0].role = static_cast<DepthRole>(3); }},
        Fault{"depth part's radius", [](ObjectModel& m) { m.bins[0].depth[0].radius = -1; }},
        Fault{"missing depth", [](ObjectModel& m) { m.bins[0].depth[0].missing = 0.021F; }},
        Fault{"missing depth", [](ObjectModel& m) { m.bins[0].depth[0].missing = -0.01F; }},
        Fault{"missing depth", [](ObjectModel& m) { m.bins[0].depth[0].missing = kNan; }},
        Fault{"vertex", [](ObjectModel& m) { m.mesh.vertices[0].x() = kNan; }},
        Fault{"vertex", [](ObjectModel& m) { m.mesh.vertices[0].x() = 1; }},
        Fault{"triangle", [](ObjectModel& m) { m.mesh.triangles[0][1] = 8; }},
        Fault{"mark", [](ObjectModel& m) { m.marks[0].point.x() = kNan; }},
        Fault{"mark", [](ObjectModel& m) { m.marks[0].point.y() = 3; }},
        Fault{"unit length", [](ObjectModel& m) { m.marks[1].direction *= 0.5F; }},
        Fault{"unit length", [](ObjectModel& m) { m.marks[1].normal.setZero(); }},
        Fault{"weight", [](ObjectModel& m) { m.confidence.weights[2] = kNan; }},
        Fault{"false detections", [](ObjectModel& m) { m.confidence.images = 2; }},
        Fault{"falling", [](ObjectModel& m) { m.confidence.false_confidences[0] = 0.1F; }},
        Fault{"falling", [](ObjectModel& m) { m.confidence.false_confidences[0] = 1.5F; }}));

TEST(PrintableUtf8, KnowsTextFromTricks) {
  for (const char* good :
       {"", "box", "Kaffeebecher gro\xc3\x9f", "\xe8\x8c\xb6", "\xf0\x9f\x8d\xb5", "a b;c\"d"}) {
    EXPECT_TRUE(is_printable_utf8(good)) << good;
  }
  for (const char* bad :
       {"a\nb", "\x7f", "\x1b[0m", "\xc2\x9b", "\xc0\x80", "\xe0\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80",
        "\xf5\x80\x80\x80", "\xe8\x8c", "\x80", "\xe2\x80\xae", "\xc3("}) {
    EXPECT_FALSE(is_printable_utf8(bad)) << bad;
  }
  EXPECT_FALSE(is_printable_utf8(std::string("a\0b", 3)));
}

}  // namespace
}  // namespace sextant
