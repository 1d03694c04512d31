#include "vesalius/forest/make_labeller.h"

#include <gmock/gmock.h>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

Forest one_leaf() {
  Forest forest;
  forest.body = paper_body();
  forest.trees.push_back({{}, {TreeLeaf{{3, 0, 0, 0}, {200, 0, 0, 0}}}});
  return forest;
}

TEST(MakeLabeller, LabelsWithTheForestOnTheProcessor) {
  for (const auto& labeller : {make_labeller(one_leaf()), make_labeller(one_leaf(), "cpu")}) {
    EXPECT_EQ(labeller->label(DepthImage(2, 2, 1000), {2, 2, 5.F, 5.F, 0.F, 0.F}).at(1, 1)[3], 200);
    EXPECT_EQ(labeller->body().name, paper_body().name);
    EXPECT_FALSE(labeller->has_background());
    EXPECT_FALSE(labeller->has_distributions());
  }
}

TEST(MakeLabeller, RefusesAnUnknownDevice) {
  for (const char* device : {"", "cuda", "CPU"}) {
    EXPECT_THAT([&] { make_labeller(one_leaf(), device); },
                testing::ThrowsMessage<UsageError>(testing::HasSubstr("is not available, expected \"cpu\"")));
  }
}

}  // namespace
}  // namespace vesalius
