#include "synth/body/surface_parts.h"

#include <gmock/gmock.h>

#include <functional>

#include "synth/body/makehuman.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const BodyModel& paper() { return paper_body(); }

std::string part_name(const SurfaceParts& rules, Bone bone, float along, bool left) {
  return paper().parts[rules.part(bone, along, left)].name;
}

TEST(SurfaceParts, LabelThePaperBodyByPlaceAndSide) {
  const SurfaceParts rules(paper());
  EXPECT_EQ(part_name(rules, Bone::l_thigh, 0.5F, true), "l_thigh");
  EXPECT_EQ(part_name(rules, Bone::l_thigh, 0.5F, false), "l_thigh");  // limbs keep their side across the middle
  EXPECT_EQ(part_name(rules, Bone::l_thigh, 0.95F, true), "l_knee");
  EXPECT_EQ(part_name(rules, Bone::r_shin, 0.1F, false), "r_knee");
  EXPECT_EQ(part_name(rules, Bone::r_shin, 0.5F, false), "r_leg");
  EXPECT_EQ(part_name(rules, Bone::chest, 0.5F, false), "r_chest");
  EXPECT_EQ(part_name(rules, Bone::head, 0.1F, true), "l_face_bottom");
  EXPECT_EQ(part_name(rules, Bone::head, 0.9F, false), "r_face_top");
}

TEST(SurfaceParts, ClampPlacesBeyondTheEndsOfABone) {
  const SurfaceParts rules(paper());
  EXPECT_EQ(part_name(rules, Bone::head, -0.6F, true), "l_face_bottom");  // the chin
  EXPECT_EQ(part_name(rules, Bone::head, 1.2F, true), "l_face_top");
  EXPECT_EQ(part_name(rules, Bone::l_forearm, -0.1F, true), "l_elbow");
}

TEST(SurfaceParts, GiveEveryPartAnAreaOnItsOwnSide) {
  const BodyMesh mesh = make_body(builtin_bodies(), {}, paper());
  std::vector<double> area(25, 0.0);
  std::vector<double> x(25, 0.0);
  for (std::size_t t = 0; t < mesh.topology->triangles.size(); ++t) {
    const Triangle& tri = mesh.topology->triangles[t];
    const Eigen::Vector3f& a = mesh.vertices[tri[0]];
    const double size = 0.5 * static_cast<double>((mesh.vertices[tri[1]] - a).cross(mesh.vertices[tri[2]] - a).norm());
    area[mesh.topology->part[t]] += size;
    x[mesh.topology->part[t]] += size * static_cast<double>(a.x());
  }
  for (std::size_t p = 0; p < 25; ++p) {
    const std::string& name = paper().parts[p].name;
    EXPECT_GT(area[p], 0.008) << name;  // square metres
    EXPECT_TRUE(!name.starts_with("l_") || x[p] / area[p] > 0.02) << name;
    EXPECT_TRUE(!name.starts_with("r_") || x[p] / area[p] < -0.02) << name;
  }
}

/// Returns the paper's body with changed surface rules.
BodyModel changed(const std::function<void(std::vector<SurfaceRule>&)>& change) {
  BodyModel body = paper();
  change(body.surface);
  return body;
}

SurfaceRule& rule_of(std::vector<SurfaceRule>& rules, const char* bone, float from) {
  return *std::ranges::find_if(rules, [&](const SurfaceRule& r) { return r.bone == bone && r.from == from; });
}

TEST(SurfaceParts, FollowOtherRulesWithoutOtherCode) {
  const BodyModel body = changed([](auto& rules) {
    for (SurfaceRule& rule : rules) rule.part = rule.bone == "head" ? 1 : 0;
  });
  const BodyMesh mesh = make_body(builtin_bodies(), {}, body);
  EXPECT_THAT(mesh.topology->part, testing::Each(testing::AnyOf(0, 1)));
  EXPECT_THAT(mesh.topology->part, testing::Contains(1));
}

TEST(SurfaceParts, NameTheFaultOfInvalidRules) {
  EXPECT_THAT([] { SurfaceParts(changed([](auto& r) { r.clear(); })); },
              ThrowsMessage<Error>(HasSubstr("no [[surface]] rules")));
  EXPECT_THAT([] { SurfaceParts(changed([](auto& r) { r[3].bone = "tail"; })); },
              ThrowsMessage<Error>(AllOf(HasSubstr("paper25:"), HasSubstr("no bone is called \"tail\""))));
  EXPECT_THAT([] { SurfaceParts(changed([](auto& r) { rule_of(r, "l_shin", 0.15F).from = 0.2F; })); },
              ThrowsMessage<Error>(HasSubstr("l_shin has no part from 0.15 to 0.2")));
  EXPECT_THAT([] { SurfaceParts(changed([](auto& r) { rule_of(r, "l_shin", 0.15F).from = 0.1F; })); },
              ThrowsMessage<Error>(HasSubstr("l_shin has two parts from 0.1 to 0.15")));
  EXPECT_THAT([] { SurfaceParts(changed([](auto& r) { rule_of(r, "neck", 0.F).to = 0.5F; })); },
              ThrowsMessage<Error>(HasSubstr("neck has no part from 0.5 to 1")));
  EXPECT_THAT([] { SurfaceParts(changed([](auto& r) { rule_of(r, "neck", 0.F).side = SurfaceRule::Side::left; })); },
              ThrowsMessage<Error>(HasSubstr("on the right, neck has no part from 0 to 1")));
}

}  // namespace
}  // namespace vesalius::synth
