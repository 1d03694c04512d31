#include "vesalius/forest/padded_depth.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

TEST(PaddedDepth, HasTheValuesThatProbesRead) {
  DepthImage depth(2, 2, 1000);
  depth(1, 0) = 0;
  depth(0, 1) = 65535;
  const PaddedDepth padded(depth, {.hole_mm = 7000, .outside_mm = 40000});
  ASSERT_EQ(padded.stride(), 3);
  EXPECT_EQ(padded.border_u(), 2);
  EXPECT_EQ(padded.border_v(), 2);
  std::vector<int> mm;
  for (int i = 0; i < 9; ++i) mm.push_back(padded.values()[i] + 32768);
  EXPECT_THAT(mm, testing::ElementsAre(1000, 7000, 40000,   //
                                       65535, 1000, 40000,  //
                                       40000, 40000, 40000));
}

}  // namespace
}  // namespace vesalius
