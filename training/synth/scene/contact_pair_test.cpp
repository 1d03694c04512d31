#include "synth/scene/contact_pair.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "synth/scene/test_plans.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

PersonPlan standing_plan(Random& random) {
  return test::plan_of(sample_pose(only(&PoseSamplerOptions::idle), random), random.next());
}

/// Returns up to `count` pairs out of four times as many tries, and how many tries they took.
std::vector<PeopleGroup> pairs(Contact contact, int count, int& tries) {
  std::vector<PeopleGroup> made;
  for (tries = 0; int(made.size()) < count && tries < 4 * count; ++tries) {
    Random random(21, static_cast<std::uint64_t>(tries));
    const PersonPlan one = standing_plan(random);
    const PersonPlan other = contact == Contact::helping_up
                                 ? test::plan_of(sample_pose(only(&PoseSamplerOptions::floor_sitting), random), 1)
                                 : standing_plan(random);
    if (auto pair = touching_pair(contact, one, 4, other, 7, random)) made.push_back(std::move(*pair));
  }
  return made;
}

Vector3f joint(const GroupMember& member, Bone bone) {
  return member.group_from_body * member.body.joints[index(bone)];
}

float between_wrists(const PeopleGroup& pair) {
  float nearest = 10.F;
  for (const Bone a : {Bone::l_hand, Bone::r_hand}) {
    for (const Bone b : {Bone::l_hand, Bone::r_hand}) {
      nearest = std::min(nearest, (joint(pair.members[0], a) - joint(pair.members[1], b)).norm());
    }
  }
  return nearest;
}

class ContactPairTest : public testing::TestWithParam<Contact> {};

TEST_P(ContactPairTest, IsPossibleInOneOfFourTriesAndStandsOnTheFloor) {
  int tries = 0;
  const std::vector<PeopleGroup> made = pairs(GetParam(), 20, tries);
  EXPECT_GE(4 * std::ssize(made), tries) << made.size() << " of " << tries;
  for (const PeopleGroup& pair : made) {
    ASSERT_EQ(pair.members.size(), 2U);
    EXPECT_EQ(pair.members[0].plan, 4);
    EXPECT_EQ(pair.members[1].plan, 7);
    for (const GroupMember& member : pair.members) EXPECT_NEAR(member.outline.bounds.min().y(), 0.F, 0.01F);
    EXPECT_LT((joint(pair.members[0], Bone::pelvis) - joint(pair.members[1], Bone::pelvis)).norm(), 1.6F);
  }
}

TEST_P(ContactPairTest, IsTheSameAgain) {
  int tries = 0;
  const std::vector<PeopleGroup> once = pairs(GetParam(), 3, tries), again = pairs(GetParam(), 3, tries);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].members[1].body.vertices, again[i].members[1].body.vertices);
    EXPECT_TRUE(once[i].members[1].group_from_body.isApprox(again[i].members[1].group_from_body, 0.F));
  }
}

INSTANTIATE_TEST_SUITE_P(Contacts, ContactPairTest,
                         testing::Values(Contact::embrace, Contact::handing, Contact::arm_around, Contact::hand_in_hand,
                                         Contact::helping_up));

TEST(ContactPair, HandsMeetWhereTheyAreHeld) {
  for (const Contact contact : {Contact::handing, Contact::hand_in_hand, Contact::helping_up}) {
    int tries = 0;
    for (const PeopleGroup& pair : pairs(contact, 20, tries)) EXPECT_LT(between_wrists(pair), 0.1F) << int(contact);
  }
}

TEST(ContactPair, WhoEmbracesHasTheHandsBehindTheOther) {
  int tries = 0;
  for (const PeopleGroup& pair : pairs(Contact::embrace, 20, tries)) {
    const GroupMember &one = pair.members[0], &other = pair.members[1];
    const Vector3f ahead = (joint(other, Bone::chest) - joint(one, Bone::chest)).normalized();
    EXPECT_LT((joint(other, Bone::chest) - joint(one, Bone::chest)).norm(), 0.5F);
    const auto behind = [&](Bone hand) { return (joint(one, hand) - joint(other, Bone::chest)).dot(ahead) > -0.02F; };
    EXPECT_TRUE(behind(Bone::l_hand) || behind(Bone::r_hand));
  }
}

}  // namespace
}  // namespace vesalius::synth
