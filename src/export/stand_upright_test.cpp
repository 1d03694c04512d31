#include "export/stand_upright.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "export/test_people.h"
#include "export/write_people.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;

constexpr float kHeight_m = 1.5F;

/// What takes a level frame on the floor (x right, y down, z ahead) into a camera over it that looks down by 40
/// degrees.
Eigen::Isometry3f tilted_camera() {
  const float tilt = 40.F * std::numbers::pi_v<float> / 180.F;
  return Eigen::AngleAxisf(tilt, Vector3f::UnitX()) * Eigen::Translation3f(0.F, kHeight_m, 0.F);
}

FloorView tilted_floor() {
  FloorView floor;
  floor.up = tilted_camera().linear() * Vector3f(0.F, -1.F, 0.F);
  floor.height_m = kHeight_m;
  return floor;
}

/// Somebody 2.5 m ahead: pelvis .9 m over the floor, whose spine goes straight up.
PeopleRecord standing() {
  PeopleRecord record = test::people();
  for (RecordedFrame& frame : record.frames) {
    for (RecordedPerson& person : frame.people) {
      for (std::vector<Joint>& set : person.person.joints) {
        for (Joint& joint : set) joint.position = tilted_camera() * Vector3f(0.3F, -0.9F, 2.5F);
      }
      for (FittedBone& bone : person.body->bones) {
        bone.head = tilted_camera() * Vector3f(0.3F, -0.9F, 2.5F);
        bone.tail = tilted_camera() * Vector3f(0.3F, -1.4F, 2.5F);
      }
    }
  }
  return record;
}

TEST(StandUpright, PutsPeopleOntoTheFloor) {
  PeopleRecord record = standing();
  record.frames[2].floor = tilted_floor();
  ASSERT_TRUE(stand_upright(record));
  for (const RecordedFrame& frame : record.frames) {
    for (const RecordedPerson& person : frame.people) {
      EXPECT_LT((person.person.joints[0][0].position - Vector3f(0.3F, -0.9F, 2.5F)).norm(), 1e-5F) << frame.name;
      const FittedBone& spine = person.body->bones[1];
      EXPECT_LT(((spine.tail - spine.head) - Vector3f(0.F, -0.5F, 0.F)).norm(), 1e-5F) << frame.name;
    }
  }
  EXPECT_THAT(to_csv(record, 0), HasSubstr(",0.3000,0.9000,-2.5000,")) << "y is up";
  EXPECT_THAT(to_trc(record, 0, 1, "a.trc"), HasSubstr("\t300.000\t900.000\t-2500.000"));
}

TEST(StandUpright, TurnsBonesWithTheirEnds) {
  PeopleRecord record = test::people(), before = test::people();
  for (RecordedFrame& frame : record.frames) frame.floor = tilted_floor();
  ASSERT_TRUE(stand_upright(record));
  const auto in_bone = [](const FittedBone& bone) -> Vector3f {
    return bone.global.conjugate() * (bone.tail - bone.head);
  };
  for (std::size_t f = 0; f < record.frames.size(); ++f) {
    const auto &now = record.frames[f].people[0].body->bones, &then = before.frames[f].people[0].body->bones;
    for (std::size_t b = 0; b < now.size(); ++b) EXPECT_LT((in_bone(now[b]) - in_bone(then[b])).norm(), 1e-5F);
  }
}

TEST(StandUpright, WithoutAFloorNothingChanges) {
  PeopleRecord record = standing();
  const std::string before = to_csv(record, 0);
  EXPECT_FALSE(stand_upright(record));
  EXPECT_EQ(to_csv(record, 0), before);
}

TEST(StandUpright, FloorsAreReadFromTheLines) {
  std::string lines = test::lines();
  lines.insert(lines.find("\"people\""),
               R"("floor":{"up":[0,-0.8,-0.6],"height_m":1.2,"tilt_degrees":36.9,"roll_degrees":0},)");
  const PeopleRecord record = parse_people(lines, "people.jsonl", {});
  ASSERT_TRUE(record.frames[0].floor);
  EXPECT_EQ(record.frames[0].floor->height_m, 1.2F);
  EXPECT_FALSE(record.frames[1].floor);
}

}  // namespace
}  // namespace vesalius
