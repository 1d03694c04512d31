#include "vesalius/merge/fuse_person.h"

#include <gtest/gtest.h>

#include "vesalius/merge/test_walkers.h"

namespace vesalius {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

class FusePerson : public testing::Test {
 protected:
  TrackedPerson someone() {
    Random random(1);
    return test::seen_walker({}, 0.F, 1, Isometry3f::Identity(), 0.F, random);
  }
  static Joint& joint(TrackedPerson& person) { return person.person.joints[0][4]; }
};

TEST_F(FusePerson, TakesTheMiddleOfTwoWhoAreAsSure) {
  TrackedPerson a = someone(), b = someone();
  joint(b).position.x() += 0.06F;
  const float before = joint(a).position.x();
  TrackedPerson fused = fuse_person({&a, &b});
  EXPECT_NEAR(joint(fused).position.x(), before + 0.03F, 1e-5F);
  EXPECT_GT(joint(fused).confidence, joint(a).confidence);
  EXPECT_EQ(joint(fused).state, State::observed);
}

TEST_F(FusePerson, GoesToWhoIsSurer) {
  TrackedPerson a = someone(), b = someone();
  joint(a).confidence = 0.2F;
  joint(a).state = State::predicted;
  joint(b).position.x() += 0.1F;
  TrackedPerson fused = fuse_person({&a, &b});
  EXPECT_GT(joint(fused).position.x(), joint(a).position.x() + 0.08F);
  EXPECT_EQ(joint(fused).state, State::observed);
}

TEST_F(FusePerson, LeavesOutWhatCannotBeTheSame) {
  TrackedPerson a = someone(), b = someone();
  joint(a).confidence = 0.95F;
  joint(b).confidence = 0.6F;
  joint(b).position.x() += 0.8F;
  TrackedPerson fused = fuse_person({&b, &a});
  EXPECT_LT((joint(fused).position - joint(a).position).norm(), 1e-5F);
}

TEST_F(FusePerson, TakesWhatOnlyOneKnows) {
  TrackedPerson a = someone(), b = someone();
  joint(a) = {};
  TrackedPerson fused = fuse_person({&a, &b});
  EXPECT_LT((joint(fused).position - joint(b).position).norm(), 1e-6F);
  joint(b) = {};
  fused = fuse_person({&a, &b});
  EXPECT_EQ(joint(fused).state, State::none);
}

TEST_F(FusePerson, FusesPartsAndCountsThem) {
  TrackedPerson a = someone(), b = someone();
  const auto set = [](SkeletonPart& part, State state, const Vector3f& at) {
    part.state = state;
    part.centre = at;
    part.confidence = 0.9F;
  };
  set(a.person.skeleton.parts[2], State::observed, {0.F, 0.F, 3.F});
  set(b.person.skeleton.parts[2], State::predicted, {0.F, 0.04F, 3.F});
  set(b.person.skeleton.parts[5], State::observed, {1.F, 0.F, 3.F});
  const TrackedPerson fused = fuse_person({&a, &b});
  const Vector3f at = fused.person.skeleton.parts[2].centre;
  EXPECT_GE(at.y(), 0.F);
  EXPECT_LE(at.y(), 0.02F + 1e-6F);
  EXPECT_EQ(fused.person.skeleton.parts[5].state, State::observed);
  EXPECT_EQ(fused.person.skeleton.found, 2);
}

}  // namespace
}  // namespace vesalius
