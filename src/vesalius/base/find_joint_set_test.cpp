#include "vesalius/base/find_joint_set.h"

#include <gmock/gmock.h>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using testing::ThrowsMessage;

BodyModel with_sets() {
  BodyModel body;
  body.joint_sets = {{"nite15", {}}, {"k4abt32", {}}};
  return body;
}

TEST(FindJointSet, GivesItsIndex) {
  EXPECT_EQ(find_joint_set(with_sets(), "nite15"), 0U);
  EXPECT_EQ(find_joint_set(with_sets(), "k4abt32"), 1U);
}

TEST(FindJointSet, NamesThoseThatThereAre) {
  EXPECT_THAT(([] { find_joint_set(with_sets(), "feet"); }),
              ThrowsMessage<UsageError>("joint set \"feet\" is not of this body, expected one of: nite15, k4abt32"));
}

}  // namespace
}  // namespace vesalius
