#include "stream/osc_messages.h"

#include <gmock/gmock.h>

#include <bit>
#include <map>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word = word << 8U | static_cast<unsigned char>(bytes.at(at + i));
  return word;
}

/// Reads a text and goes to what follows it.
std::string text_at(const std::string& bytes, std::size_t& at) {
  const std::string text = bytes.c_str() + at;
  at += (text.size() / 4 + 1) * 4;
  return text;
}

/// Messages of bundles by their addresses: types and words.
std::map<std::string, std::pair<std::string, std::vector<std::uint32_t>>> read(
    const std::vector<std::string>& bundles) {
  std::map<std::string, std::pair<std::string, std::vector<std::uint32_t>>> messages;
  for (const std::string& bundle : bundles) {
    EXPECT_LE(bundle.size(), 1432U);
    EXPECT_EQ(bundle.size() % 4, 0U);
    std::size_t at = 0;
    EXPECT_EQ(text_at(bundle, at), "#bundle");
    at += 8;
    while (at < bundle.size()) {
      const std::size_t end = at + 4 + word_at(bundle, at);
      at += 4;
      const std::string address = text_at(bundle, at);
      auto& [types, words] = messages[address];
      types = text_at(bundle, at);
      for (; at < end; at += 4) words.push_back(word_at(bundle, at));
    }
  }
  return messages;
}

TEST(OscMessage, IsWhatTheSpecificationShows) {
  // The second example of "OSC Message Examples" in the specification 1.0.
  const std::string bytes = OscMessage("/foo").add(1000).add(-1).add("hello").add(1.234F).add(5.678F).bytes();
  const std::string expected(
      "/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d", 40);
  EXPECT_EQ(bytes, expected);
}

Person person_at(const BodyModel& body, float x) {
  Person person;
  for (const JointSet& set : body.joint_sets) {
    person.joints.emplace_back(set.joints.size(), Joint{State::observed, {x, -0.5F, 2.F}, 0.75F});
  }
  person.joints[0][1].state = State::none;
  return person;
}

TEST(OscBundles, SendEveryJointThatHasAPlaceWithYUp) {
  const BodyModel body = paper_body();
  const JointSet& set = body.joint_sets[0];
  const auto messages =
      read(osc_bundles(seen_people({person_at(body, 0.25F), person_at(body, 1.F)}), body, {set.name}));
  EXPECT_EQ(messages.at("/vesalius/people").first, ",iii");
  EXPECT_THAT(messages.at("/vesalius/people").second, testing::ElementsAre(2, 0, 1));
  EXPECT_EQ(messages.at("/vesalius/1/state").first, ",s");
  const auto& [types, words] = messages.at("/vesalius/0/" + set.joints[0].name);
  EXPECT_EQ(types, ",ffff");
  EXPECT_THAT(words, testing::ElementsAre(std::bit_cast<std::uint32_t>(0.25F), std::bit_cast<std::uint32_t>(0.5F),
                                          std::bit_cast<std::uint32_t>(-2.F), std::bit_cast<std::uint32_t>(0.75F)));
  EXPECT_FALSE(messages.contains("/vesalius/0/" + set.joints[1].name));
  EXPECT_EQ(messages.size(), 1 + 2 * set.joints.size());
}

TEST(OscBundles, SendIdsAndStatesOfPeopleWhoAreFollowed) {
  const BodyModel body = paper_body();
  TrackedFrame tracked;
  tracked.people.resize(1);
  tracked.people[0].id = 17;
  tracked.people[0].state = TrackState::hidden;
  tracked.people[0].person = person_at(body, 0.F);
  tracked.people[0].position = {0.F, 0.125F, 3.F};
  const auto messages = read(osc_bundles(tracked, body, {body.joint_sets[0].name}));
  EXPECT_THAT(messages.at("/vesalius/people").second, testing::ElementsAre(1, 17));
  EXPECT_THAT(messages.at("/vesalius/17/position").second,
              testing::ElementsAre(std::bit_cast<std::uint32_t>(-0.F + 0.F), std::bit_cast<std::uint32_t>(-0.125F),
                                   std::bit_cast<std::uint32_t>(-3.F)));
  EXPECT_EQ(messages.at("/vesalius/17/state").second.front(), 0x68696464U) << "hidd";
  // From a camera 1.5 m over the floor that looks straight down, 1.375 m lie below, and what is below in its picture is
  // behind.
  tracked.floor = FloorView{{0.F, 0.F, -1.F}, 1.5F, 1.57F, 0.F};
  const auto on_floor = read(osc_bundles(tracked, body, {body.joint_sets[0].name}));
  EXPECT_THAT(
      on_floor.at("/vesalius/17/position").second,
      testing::ElementsAre(testing::_, std::bit_cast<std::uint32_t>(-1.5F), std::bit_cast<std::uint32_t>(0.125F)));
  EXPECT_EQ(read(osc_bundles(tracked, body, {body.joint_sets[0].name, false})), messages);
  EXPECT_TRUE(read(osc_bundles(TrackedFrame{}, body, {body.joint_sets[0].name})).contains("/vesalius/people"));
  EXPECT_THROW(osc_bundles(tracked, body, {"body99"}), UsageError);
}

}  // namespace
}  // namespace vesalius
