#include "io/sources/list_source.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

namespace vesalius {
namespace {

using testing::ElementsAre;

TEST(ToMillimetres, RoundsAndDropsValuesThatDoNotFit) {
  Image<std::uint16_t> stored(5, 1);
  const std::uint16_t units[] = {0, 7, 8, 5000, 65535};
  std::copy(std::begin(units), std::end(units), stored.begin());
  const DepthImage tum = to_millimetres(stored, 5000.F);
  EXPECT_THAT(std::vector<int>(tum.begin(), tum.end()), ElementsAre(0, 1, 2, 1000, 13107));
  const DepthImage cm = to_millimetres(stored, 100.F);
  EXPECT_THAT(std::vector<int>(cm.begin(), cm.end()), ElementsAre(0, 70, 80, 50000, 0));
}

}  // namespace
}  // namespace vesalius
