#include "vesalius/person_json.h"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "vesalius/error.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {
namespace {

using nlohmann::json;

const TrackedFrame kNobody = seen_people({});

/// One person of whom the neck was seen and the left hand inferred.
Person half_seen(const BodyModel& body) {
  Person person;
  person.score = 0.5F;
  person.box = {10, 20, 30, 40};
  person.skeleton.parts.resize(body.parts.size());
  SkeletonPart& neck = person.skeleton.parts[body.find_part("neck")];
  neck.state = State::observed;
  neck.centre = {0.12345F, -1.F, 2.5F};
  neck.confidence = 0.75F;
  SkeletonPart& hand = person.skeleton.parts[body.find_part("l_hand")];
  hand.state = State::predicted;
  hand.centre = {1.F, 2.F, 3.F};
  const Joint unknown{State::none, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()), 0.F};
  for (const JointSet& set : body.joint_sets) person.joints.emplace_back(set.joints.size(), unknown);
  person.joints[0][1] = {State::observed, {0.F, 0.5F, 2.F}, 0.25F};
  return person;
}

Frame named(const std::string& name) {
  Frame frame;
  frame.name = name;
  frame.time_s = 1.5;
  frame.camera = {320, 240, 250.F, 262.1F, 160.F, 120.F};
  return frame;
}

TEST(PersonJson, NobodyIsAnEmptyList) {
  EXPECT_EQ(
      frame_json(named("0172"), kNobody, paper_body()),
      R"({"frame":"0172","time_s":1.5,"camera":{"width":320,"height":240,"fx":250.0,"fy":262.1,"cx":160.0,"cy":120.0},"people":[]})");
}

TEST(PersonJson, SaysWhereUpIsIfTheFrameKnows) {
  Frame frame = named("a");
  EXPECT_FALSE(json::parse(frame_json(frame, kNobody, paper_body())).contains("up"));
  frame.up = {0.F, -0.8F, 0.6F};
  EXPECT_EQ(json::parse(frame_json(frame, kNobody, paper_body())).at("up"), json({0.0, -0.8, 0.6}));
}

TEST(PersonJson, OfOneSetInBriefFitsTwoKilobytes) {
  const BodyModel& body = paper_body();
  TrackedFrame tracked = seen_people({half_seen(body)});
  tracked.followed = true;
  TrackedPerson& person = tracked.people[0];
  for (std::vector<Joint>& set : person.person.joints) {
    for (Joint& joint : set) joint = {State::predicted, {-1.2345F, -0.9876F, 3.4567F}, 0.1234F, Unseen::no_depth};
  }
  person.smoothed = person.person.joints;
  const std::string line = frame_json(named("f"), tracked, body, 12.5, {"coco17", true});
  EXPECT_LE(line.size(), 2000U);
  const json read = json::parse(line), whole = json::parse(frame_json(named("f"), tracked, body, 12.5));
  const json &one = read.at("people").at(0), &all = whole.at("people").at(0);
  EXPECT_EQ(one.at("joints").size(), 1U);
  json nose = all.at("joints").at("coco17").at("nose");
  nose.erase("px");
  nose.erase("unseen");
  EXPECT_EQ(one.at("joints").at("coco17").at("nose"), nose);
  for (const char* gone : {"parts", "body", "smoothed"}) EXPECT_FALSE(one.contains(gone)) << gone;
  for (const char* kept : {"id", "state", "position_m", "score", "yaw", "box_px"})
    EXPECT_EQ(one.at(kept), all.at(kept)) << kept;
  const json nite = json::parse(frame_json(named("f"), tracked, body, {}, {"nite15", false})).at("people").at(0);
  EXPECT_EQ(nite.at("joints").size(), 1U);
  EXPECT_EQ(nite.at("smoothed").size(), 1U);
  EXPECT_EQ(nite.at("parts"), all.at("parts"));
  EXPECT_THROW(frame_json(named("f"), tracked, body, {}, {"feet", false}), UsageError);
}

TEST(PersonJson, ListsEveryPartAndJoint) {
  const BodyModel& body = paper_body();
  const std::string line = frame_json(named("f"), seen_people({half_seen(body)}), body);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const json person = json::parse(line).at("people").at(0);
  EXPECT_EQ(person.at("index"), 0);
  EXPECT_EQ(person.at("score"), 0.5);
  EXPECT_TRUE(person.at("yaw").is_null());
  EXPECT_EQ(person.at("box_px"), json({10, 20, 30, 40}));
  EXPECT_EQ(person.at("parts").size(), 25U);
  EXPECT_EQ(person.at("parts").at("neck"),
            json::parse(R"({"xyz_m":[0.1235,-1.0,2.5],"px":[172.3,15.2],"confidence":0.75,"state":"observed"})"));
  EXPECT_EQ(person.at("parts").at("l_hand").at("state"), "predicted");
  EXPECT_EQ(person.at("parts").at("r_foot"),
            json::parse(R"({"xyz_m":null,"px":null,"confidence":0.0,"state":"none"})"));
  EXPECT_EQ(person.at("joints").at("nite15").size(), 15U);
  EXPECT_EQ(person.at("joints").at("nite15").at("neck").at("xyz_m"), json({0.0, 0.5, 2.0}));
  EXPECT_TRUE(person.at("joints").at("coco17").at("nose").at("xyz_m").is_null());
}

TEST(PersonJson, SaysWhyWhatIsNotObservedIsNot) {
  const BodyModel& body = paper_body();
  Person person = half_seen(body);
  SkeletonPart& hand = person.skeleton.parts[body.find_part("l_hand")];
  hand.unseen = Unseen::behind_person;
  hand.behind = 2;
  person.joints[0][0].unseen = Unseen::out_of_picture;
  const json read = json::parse(frame_json(named("f"), seen_people({person}), body)).at("people").at(0);
  EXPECT_EQ(read.at("parts").at("l_hand").at("unseen"), "behind_person");
  EXPECT_EQ(read.at("parts").at("l_hand").at("behind"), 2);
  EXPECT_FALSE(read.at("parts").at("neck").contains("unseen"));
  const json& head = read.at("joints").at("nite15").at("head");
  EXPECT_EQ(head.at("unseen"), "out_of_picture");
  EXPECT_FALSE(head.contains("behind"));
}

TEST(PersonJson, AYawIsGivenInDegrees) {
  const BodyModel& body = paper_body();
  Person person = half_seen(body);
  person.yaw = YawEstimate{-std::numbers::pi_v<float> / 2.F, 0.875F};
  const json yaw = json::parse(frame_json(named("f"), seen_people({person}), body)).at("people").at(0).at("yaw");
  EXPECT_EQ(yaw, json::parse(R"({"degrees":-90.0,"confidence":0.875})"));
}

TEST(PersonJson, AnUnknownTimeIsNull) {
  Frame frame = named("f");
  frame.time_s.reset();
  EXPECT_TRUE(json::parse(frame_json(frame, kNobody, paper_body())).at("time_s").is_null());
  EXPECT_FALSE(json::parse(frame_json(frame, kNobody, paper_body())).contains("arrived_s"));
  frame.arrived_s = 1.7e9;
  const json live = json::parse(frame_json(frame, kNobody, paper_body(), 12.5));
  EXPECT_EQ(live.at("arrived_s"), 1.7e9);
  EXPECT_EQ(live.at("latency_ms"), 12.5);
}

TEST(PersonJson, APointBehindTheCameraHasNoPixel) {
  const BodyModel& body = paper_body();
  Person person = half_seen(body);
  person.skeleton.parts[body.find_part("neck")].centre.z() = -0.1F;
  const json neck =
      json::parse(frame_json(named("f"), seen_people({person}), body)).at("people").at(0).at("parts").at("neck");
  EXPECT_TRUE(neck.at("px").is_null());
  EXPECT_FALSE(neck.at("xyz_m").is_null());
}

TEST(PersonJson, PeopleWhoAreFollowedHaveIdsStatesAndVelocities) {
  const BodyModel& body = paper_body();
  TrackedPerson tracked;
  tracked.id = 7;
  tracked.state = TrackState::hidden;
  tracked.person = half_seen(body);
  tracked.position = {0.1F, 0.2F, 2.5F};
  tracked.velocity = {-0.5F, 0.F, 1.F};
  tracked.stance = Stance::sitting;
  tracked.leaving = true;
  tracked.since_s = 1.25;
  tracked.seen_s = 2.0;
  TrackedFrame frame{
      2.5, {tracked}, FloorView{{0.F, -0.8F, -0.6F}, 1.5F, 0.643501F, 0.F}, {{7, 2.25, Stance::sitting}}};
  const json line = json::parse(frame_json(named("f"), frame, body));
  EXPECT_EQ(line.at("time_s"), 1.5) << "the frame's own";
  EXPECT_EQ(line.at("track_time_s"), 2.5);
  EXPECT_EQ(line.at("floor"), json::parse(R"({"up":[0.0,-0.8,-0.6],"height_m":1.5,"tilt_degrees":36.9,
                                              "roll_degrees":0.0})"));
  EXPECT_EQ(line.at("events"), json::parse(R"([{"id":7,"time_s":2.25,"stance":"sitting"}])"));
  const json person = line.at("people").at(0);
  EXPECT_EQ(person.at("id"), 7);
  EXPECT_EQ(person.at("state"), "hidden");
  EXPECT_EQ(person.at("position_m"), json({0.1, 0.2, 2.5}));
  EXPECT_EQ(person.at("velocity_m_s"), json({-0.5, 0.0, 1.0}));
  EXPECT_EQ(person.at("stance"), "sitting");
  EXPECT_EQ(person.at("leaving"), true);
  EXPECT_EQ(person.at("since_s"), 1.25);
  EXPECT_EQ(person.at("seen_s"), 2.0);
  const json alone = json::parse(frame_json(named("f"), seen_people({half_seen(body)}), body)).at("people").at(0);
  for (const auto& [key, value] : alone.items()) EXPECT_EQ(person.at(key), value) << key;
  EXPECT_FALSE(person.contains("smoothed"));
  EXPECT_FALSE(person.contains("cameras")) << "there is one";
  frame.people[0].seen_by = {{0, 3, TrackState::hidden}, {2, 5, TrackState::tracked}};
  EXPECT_EQ(json::parse(frame_json(named("f"), frame, body)).at("people").at(0).at("cameras"),
            json::parse(R"([{"camera":0,"id":3,"state":"hidden"},{"camera":2,"id":5,"state":"tracked"}])"));
  frame.people[0].smoothed = tracked.person.joints;
  frame.floor.reset();
  const json smoothed = json::parse(frame_json(named("f"), frame, body));
  EXPECT_EQ(smoothed.at("people").at(0).at("smoothed"), person.at("joints"));
  EXPECT_TRUE(smoothed.at("floor").is_null());
}

TEST(PersonJson, FittedBodiesHaveTheRotationsOfTheJointsThatTheyKnow) {
  const BodyModel& body = paper_body();
  TrackedPerson tracked;
  tracked.person = half_seen(body);
  FittedBody& fitted = tracked.body.emplace();
  for (std::size_t b = 0; b < builtin_flesh().bones.size(); ++b) {
    FittedBone& bone = fitted.bones.emplace_back();
    bone.state = State::predicted;
    bone.tail = {0.F, 1.F, 0.F};
  }
  const json person =
      json::parse(frame_json(named("f"), TrackedFrame{0.0, {tracked}, {}, {}}, body)).at("people").at(0);
  const json& sets = person.at("body").at("joint_rotations_xyzw");
  ASSERT_EQ(sets.size(), 1U) << "other sets have none";
  EXPECT_EQ(sets.at("k4abt32").size(), 30U);
  EXPECT_FALSE(sets.at("k4abt32").contains("l_thumb"));
  // The bone's frame is the optical one: x along y, y along z, z along x.
  EXPECT_EQ(sets.at("k4abt32").at("pelvis"), json({0.5, 0.5, 0.5, 0.5}));
  fitted.bones.assign(fitted.bones.size(), {});
  const json nothing =
      json::parse(frame_json(named("f"), TrackedFrame{0.0, {tracked}, {}, {}}, body)).at("people").at(0);
  EXPECT_TRUE(nothing.at("body").at("joint_rotations_xyzw").empty());
}

TEST(PersonJson, TheLastLineSaysWhetherAllIsThere) {
  EXPECT_EQ(closing_json(3, true), R"({"complete":true,"frames":3})");
  EXPECT_EQ(closing_json(2, false, "interrupted"), R"({"complete":false,"frames":2,"why":"interrupted"})");
}

TEST(PersonJson, AnyFileNameGivesValidJson) {
  const std::string line = frame_json(named("a\"b\\\xff\n"), kNobody, paper_body());
  EXPECT_TRUE(json::parse(line).at("frame").is_string());
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

TEST(PersonJson, PartTableNumbersTheLabels) {
  const json table = json::parse(part_table_json(paper_body()));
  EXPECT_EQ(table.at("background"), 255);
  ASSERT_EQ(table.at("parts").size(), 25U);
  EXPECT_EQ(table.at("parts").at(10).at("name"), "neck");
  EXPECT_EQ(table.at("parts").at(10).at("label"), 10);
  EXPECT_EQ(table.at("parts").at(10).at("colour"), json({255, 255, 102}));
  EXPECT_EQ(table.at("parts").at(0).at("mirror"), 4);
}

TEST(JsonDatagrams, AreOneForEachPersonWhereAllAreTooLarge) {
  const std::string line = R"({"frame":"1","time_s":2.0,"people":[{"id":3,"x":"aaaa"},{"id":5,"x":"bbbb"}]})";
  EXPECT_THAT(json_datagrams(line, line.size()), testing::ElementsAre(line));
  EXPECT_THAT(json_datagrams(line, line.size() - 1),
              testing::ElementsAre(R"({"frame":"1","time_s":2.0,"people":[{"id":3,"x":"aaaa"}],"part":0,"parts":2})",
                                   R"({"frame":"1","time_s":2.0,"people":[{"id":5,"x":"bbbb"}],"part":1,"parts":2})"));
}

}  // namespace
}  // namespace vesalius
