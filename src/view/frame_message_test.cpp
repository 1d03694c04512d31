#include "view/frame_message.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "capsule/capsule_person.h"
#include "io/recordings/depth_codecs.h"
#include "vesalius/base/random.h"
#include "vesalius/fit/flesh_sections.h"
#include "vesalius/fit/test_flesh.h"
#include "vesalius/image_file.h"
#include "vesalius/person_json.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/trace.h"
#include "view/test_runs.h"

namespace vesalius {
namespace {

using nlohmann::json;

/// A message taken apart as the page does it.
class Parts {
 public:
  explicit Parts(std::string message) : message_(std::move(message)) {
    for (int i = 3; i >= 0; --i) head_bytes_ = head_bytes_ << 8U | static_cast<unsigned char>(message_[i]);
    head = json::parse(message_.substr(4, head_bytes_));
  }
  std::string bytes(const std::string& name) const {
    for (const json& picture : head.at("pictures")) {
      if (picture.at("name") == name)
        return message_.substr(4 + head_bytes_ + picture.at("at").get<std::size_t>(), picture.at("bytes"));
    }
    return "none";
  }
  LabelImage labels(const std::string& name) const { return test::unpack_runs(bytes(name), 160, 120); }

  json head;

 private:
  std::string message_;
  std::size_t head_bytes_ = 0;
};

ViewedFrame viewed_person(bool with_colour) {
  CapsuleScene scene;
  scene.people.emplace_back();
  scene.floor_y_m = 1.F;
  ViewedFrame viewed;
  Frame frame = render(scene, {160, 120, 131.F, 131.F, 79.5F, 59.5F}, paper_body()).frame;
  frame.name = "one";
  if (!with_colour) frame.colour = {};
  viewed.frame = std::make_shared<const Frame>(std::move(frame));
  viewed.number = 7;
  Person person;
  person.skeleton.parts.resize(25);
  person.skeleton.parts[3].state = State::observed;
  person.skeleton.parts[3].centre = {0.1F, 0.2F, 2.F};
  for (const JointSet& set : paper_body().joint_sets) person.joints.emplace_back(set.joints.size());
  person.mask = Mask(160, 120, 0);
  person.labels = LabelImage(160, 120, kBackground);
  for (int i = 5000; i < 5100; ++i) person.mask[i] = 1, person.labels[i] = 3;
  person.score = 0.9F;
  viewed.people = seen_people({person});
  viewed.planes = find_planes(viewed.frame->depth, viewed.frame->camera, {});
  return viewed;
}

TEST(FrameMessage, HoldsTheFrameAndItsPeople) {
  const ViewedFrame viewed = viewed_person(true);
  const FrameMessages messages = frame_messages(viewed, paper_body());
  EXPECT_EQ(messages.with_stages, "");
  const Parts parts(messages.plain);
  EXPECT_EQ(parts.head.at("number"), 7);
  EXPECT_EQ(parts.head.at("found"), json::parse(frame_json(*viewed.frame, viewed.people, paper_body())));
  EXPECT_EQ(unpack_rvl(parts.bytes("depth"), 160, 120, "depth"), viewed.frame->depth);
  EXPECT_EQ(parts.labels("people"), body_index_map(people_of(viewed.people), 160, 120));
  EXPECT_EQ(parts.labels("parts"), part_label_map(people_of(viewed.people), 160, 120));
  const ColourImage colour = decode_colour(parts.bytes("colour"), "colour");
  double difference = 0.0;
  for (std::size_t i = 0; i < colour.size(); ++i) difference += std::abs(colour[i].g - viewed.frame->colour[i].g);
  EXPECT_LT(difference / static_cast<double>(colour.size()), 4.0);
  EXPECT_FALSE(parts.head.contains("stages"));
  EXPECT_NEAR(parts.head.at("floor").at("offset_m"), 1.0, 0.02);
  EXPECT_NEAR(parts.head.at("floor").at("normal").at(1), 1.0, 0.01);
}

TEST(FrameMessage, HoldsPeopleWhoAreFollowed) {
  ViewedFrame viewed = viewed_person(true);
  TrackedFrame tracked;
  TrackedPerson hidden;
  hidden.id = 2;
  hidden.state = TrackState::hidden;
  hidden.person = viewed.people.people[0].person;
  hidden.person.mask = {};
  hidden.person.labels = {};
  TrackedPerson seen;
  seen.id = 5;
  seen.state = TrackState::tracked;
  seen.person = viewed.people.people[0].person;
  const BodyState state = test::usual_state(0.0);
  FittedBody& fitted = seen.body.emplace();
  for (const PlacedBone& placed : place_bones(builtin_flesh(), state)) {
    FittedBone& bone = fitted.bones.emplace_back();
    bone.head = placed.head.cast<float>();
    bone.global = Eigen::Quaternionf(placed.global.cast<float>());
  }
  tracked.people = {hidden, seen};
  tracked.floor = FloorView{{0.F, -1.F, 0.F}, 0.9F, 0.F, 0.F};
  viewed.people = tracked;
  viewed.track_ms = 2.5;
  const Parts parts(frame_messages(viewed, paper_body()).plain);
  EXPECT_EQ(parts.head.at("found"), json::parse(frame_json(*viewed.frame, tracked, paper_body())));
  EXPECT_EQ(parts.head.at("track_ms"), 2.5);
  const LabelImage index = parts.labels("people");
  EXPECT_EQ(index[5000], 1) << "the second in the list";
  EXPECT_EQ(std::ranges::count(index, 0), 0) << "nobody sees the first";
  EXPECT_EQ(parts.labels("parts")[5000], 3);
  EXPECT_EQ(parts.head.at("floor"), json::parse(R"({"normal":[0.0,1.0,0.0],"offset_m":0.9,"lasting":true})"));
  const json& flesh = parts.head.at("flesh");
  ASSERT_EQ(flesh.size(), 2U);
  EXPECT_TRUE(flesh.at(0).is_null());
  ASSERT_EQ(flesh.at(1).size(), builtin_flesh().bones.size());
  const BoneSections pelvis = flesh_sections(builtin_flesh(), fitted).at(0);
  const json& section = flesh.at(1).at(0).at(2);
  ASSERT_EQ(section.size(), 9U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(section.at(i), pelvis[2].centre[i], 6e-4);
    EXPECT_NEAR(section.at(3 + i), pelvis[2].first[i], 6e-4);
    EXPECT_NEAR(section.at(6 + i), pelvis[2].second[i], 6e-4);
  }
}

TEST(FrameMessage, HoldsTheStagesOfATrace) {
  ViewedFrame viewed = viewed_person(false);
  Trace& trace = viewed.trace.emplace();
  trace.raw_labels = trace.labels = viewed.people.people[0].person.labels;
  trace.flat = Mask(160, 120, 1);
  trace.clusters.items.resize(1);
  trace.clusters.items[0].label = 3;
  trace.clusters.items[0].pixels = 100;
  trace.clusters.index = Image<std::int32_t>(160, 120, -1);
  for (int i = 5000; i < 5100; ++i) trace.clusters.index[i] = 0;
  trace.rough.push_back(viewed.people.people[0].person.skeleton);
  // Two candidates claim the same pixels: the first is the surer one.
  Trace::Candidate candidate;
  candidate.rough = candidate.refined = viewed.people.people[0].person.skeleton;
  candidate.grown = viewed.people.people[0].person.mask;
  candidate.labels = viewed.people.people[0].person.labels;
  candidate.accepted = true;
  trace.candidates = {candidate, candidate};
  trace.candidates[1].accepted = false;
  trace.candidates[1].grown[0] = 1;
  const FrameMessages messages = frame_messages(viewed, paper_body());
  EXPECT_FALSE(Parts(messages.plain).head.contains("stages"));
  const Parts parts(messages.with_stages);
  EXPECT_EQ(parts.bytes("colour"), "none");
  for (const char* name : {"raw_labels", "labels", "proposals", "second_pass"}) {
    EXPECT_EQ(parts.labels(name), trace.labels) << name;
  }
  EXPECT_EQ(parts.labels("flat"), trace.flat);
  const LabelImage grown = parts.labels("grown");
  EXPECT_EQ(grown[0], 1);
  EXPECT_EQ(grown[5000], 0);
  EXPECT_EQ(grown[4999], kBackground);
  const json& stages = parts.head.at("stages");
  EXPECT_EQ(stages.at("proposals").at(0).at("pixels"), 100);
  EXPECT_EQ(stages.at("rough").at(0).at("parts").at(3), (json{0.1, 0.2, 2.0}));
  EXPECT_EQ(stages.at("rough").at(0).at("parts").at(4), nullptr);
  EXPECT_EQ(stages.at("candidates").at(0).at("accepted"), true);
  EXPECT_EQ(stages.at("candidates").at(1).at("accepted"), false);
}

TEST(RunLengths, ArePairsOfValueAndLength) {
  Image<std::uint8_t> image(100, 3, 255);
  image(0, 0) = 7;
  // 1 pixel of 7; 299 = 2 * 128 + 43 of 255
  EXPECT_EQ(pack_runs(image), "\x07\x01\xff\xab\x02");
  EXPECT_EQ(pack_runs({}), "");
}

TEST(RunLengths, ComeBackAsTheyWere) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    Image<std::uint8_t> image(1 + static_cast<int>(random.below(300)), 1 + static_cast<int>(random.below(200)));
    const std::uint32_t change = 1 + random.below(400);
    std::uint8_t value = 0;
    for (std::uint8_t& pixel : image) {
      if (random.below(change) == 0) value = static_cast<std::uint8_t>(random.below(256));
      pixel = value;
    }
    EXPECT_EQ(test::unpack_runs(pack_runs(image), image.width(), image.height()), image);
  }
}

}  // namespace

}  // namespace vesalius
