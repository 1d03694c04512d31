#include "export/people_record.h"

#include <gmock/gmock.h>

#include <string>

#include "export/test_people.h"
#include "vesalius/error.h"
#include "vesalius/person_json.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ParsePeople, ReadsFramesPeopleJointsAndBodies) {
  const PeopleRecord record = test::people();
  ASSERT_EQ(record.frames.size(), test::kFrames);
  EXPECT_THAT(record.sets, testing::ElementsAre("k4abt32", "coco17"));
  EXPECT_THAT(record.bones, testing::ElementsAre("pelvis", "spine", "l_thigh"));
  EXPECT_EQ(record.frames[2].people.size(), 1U);
  EXPECT_DOUBLE_EQ(record.frames[2].time_s, 0.08);
  const RecordedPerson& person = record.frames[1].people[1];
  EXPECT_EQ(person.id, 7);
  EXPECT_FLOAT_EQ(person.person.joints[1][0].position.x(), 1.1F);
  EXPECT_EQ(person.person.joints[0][1].state, State::none);
  EXPECT_TRUE(person.rotations[0][1].has_value());
  EXPECT_FALSE(person.rotations[0][0].has_value());
  EXPECT_EQ(record.find_set("coco17"), 1U);
  EXPECT_THAT([&] { (void)record.find_set("body25"); }, ThrowsMessage<UsageError>(HasSubstr("k4abt32, coco17")));
}

TEST(ParsePeople, LeavesOutALastLineThatIsCut) {
  const std::string line = frame_json({}, TrackedFrame{}, BodyModel{});
  const PeopleRecord record = parse_people(line + "\n" + line.substr(0, line.size() / 2), "x", {});
  EXPECT_EQ(record.frames.size(), 1U);
  EXPECT_THAT(record.notes, testing::ElementsAre("x: line 2 is cut and left out"));
  EXPECT_THAT(parse_people(line + "\n" + line, "x", {}).notes, testing::IsEmpty()) << "only its end is missing";
  for (const std::string& bad : {line.substr(0, line.size() / 2) + "\n" + line, line.substr(0, 9)}) {
    EXPECT_THAT([&] { (void)parse_people(bad, "x", {}); }, ThrowsMessage<Error>(HasSubstr("line 1: no JSON"))) << bad;
  }
}

TEST(ParsePeople, GivesBackTheFieldsThatWereWritten) {
  TrackedPerson person;
  person.id = 7;
  person.state = TrackState::hidden;
  person.position = {0.25F, -0.5F, 2.F};
  person.velocity = {0.5F, 0.F, -1.F};
  person.stance = Stance::fallen;
  person.leaving = true;
  person.seen_s = 2.5;
  person.person.score = 0.75F;
  person.person.box = {1, 2, 3, 4};
  const PeopleRecord record =
      parse_people(frame_json({}, TrackedFrame{3.0, {person}, {}, {}}, BodyModel{}) + "\n" +
                       R"({"frame":"old","camera":{"width":4,"height":3,"fx":1,"fy":1,"cx":1,"cy":1},"track_time_s":4,)"
                       R"("people":[{"id":8,"joints":{}}]})",
                   "x", {});
  const RecordedPerson& read = record.frames.at(0).people.at(0);
  EXPECT_EQ(read.id, 7);
  EXPECT_EQ(read.state, TrackState::hidden);
  EXPECT_EQ(read.position, person.position);
  EXPECT_EQ(read.velocity, person.velocity);
  EXPECT_EQ(read.stance, Stance::fallen);
  EXPECT_TRUE(read.leaving);
  EXPECT_EQ(read.seen_s, 2.5);
  EXPECT_EQ(read.person.score, 0.75F);
  EXPECT_EQ(read.person.box.height, 4);
  EXPECT_EQ(record.frames.at(1).people.at(0).stance, Stance::unknown) << "a line of before that field";
}

TEST(ParsePeople, CountsFramesWithoutTimes) {
  const std::string frame =
      R"({"frame":"1","time_s":null,"camera":{"width":4,"height":3,"fx":1,"fy":1,"cx":1,"cy":1},"people":[]})";
  const PeopleRecord record = parse_people(frame + "\n\n" + frame, "x", {.rate_hz = 10.0});
  ASSERT_EQ(record.frames.size(), 2U);
  EXPECT_DOUBLE_EQ(record.frames[1].time_s, 0.1);
}

TEST(ParsePeople, SaysWhereALineIsNotAsExpected) {
  const auto refused = [](std::string text, const std::string& from, const std::string& to, const std::string& why) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    EXPECT_THAT([&] { parse_people(text, "p.jsonl", {}); },
                ThrowsMessage<Error>(testing::AllOf(HasSubstr("p.jsonl: line 1: "), HasSubstr(why))));
  };
  const std::string good = test::lines();
  refused(good, "\"people\":", "\"nobody\":", "expected a line of vesalius detect --json");
  refused(good, "[0.1,0.2,2.0]", "[0.1,0.2]", "expected 3 numbers");
  refused(good, "\"score\":0.9", "\"score\":\"high\"", "expected a line");
  refused(good, "{\"frame\"", "\"frame\"", "no JSON from byte");
  refused(good, "[-0.5,0.5,-0.5,0.5]", "[0,0,0,0]", "expected a quaternion");
  std::string other_joint = good;
  other_joint.replace(other_joint.find("\"l_wrist\":"), 9, "\"l_rist\"");
  EXPECT_THAT([&] { parse_people(other_joint, "p.jsonl", {}); }, ThrowsMessage<Error>(HasSubstr("p.jsonl: line 2: ")));
  refused(good, "\"score\":0.9", "\"score\":1e999", "number overflow");
  refused(good, "\"id\":1,", "\"id\":1e39,", "1e+39: expected at most 10^12");
  refused(good, "\"id\":1,", "\"id\":1.5,", "1.5: expected a whole number");
  refused(good, "\"width\":640", "\"width\":3000000000", "expected a whole number");
  EXPECT_THAT([] { parse_people("[]", "p.jsonl", {}); }, ThrowsMessage<Error>(HasSubstr("expected an object")));
  for (const char* empty : {"", "\n\n", "{\"complete\":true,\"frames\":0}"}) {
    EXPECT_THAT([&] { parse_people(empty, "p.jsonl", {}); }, ThrowsMessage<Error>(HasSubstr("p.jsonl: no frames")));
  }
  std::string back = good;
  back.replace(back.find("0.04,"), 5, "9.04,");
  EXPECT_THAT([&] { parse_people(back, "p.jsonl", {}); }, ThrowsMessage<Error>(HasSubstr("line 3: a time before")));
}

TEST(ParsePeople, ReadsTheShapesOfBodies) {
  std::string lines = test::lines();
  const std::size_t at = lines.find(R"("bones":)");
  lines.insert(at, R"("shape":[0.5,-1.25],)");
  const PeopleRecord record = parse_people(lines, "people.jsonl", {});
  EXPECT_EQ(record.frames[0].people[0].body->shape, (std::vector<float>{0.5F, -1.25F}));
  EXPECT_TRUE(record.frames[1].people[0].body->shape.empty()) << "a line of a version before";
  lines.replace(lines.find("-1.25"), 5, "true");
  EXPECT_THROW(parse_people(lines, "people.jsonl", {}), Error);
}

}  // namespace
}  // namespace vesalius
