#include "vesalius/base/depth_reading.h"

#include <gtest/gtest.h>

#include <limits>
#include <utility>

namespace vesalius {
namespace {

TEST(DepthReading, RoundsMetresToMillimetres) {
  for (const auto& [metres, mm] :
       {std::pair{1.2344F, 1234}, {1.2346F, 1235}, {0.001F, 1}, {0.0004F, 0}, {65.534F, 65534}}) {
    EXPECT_EQ(depth_reading(metres), mm) << metres;
  }
}

TEST(DepthReading, IsNoneOfWhatIsNoDistance) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  for (const float metres : {0.F, -1.F, kNan, kInfinity, -kInfinity, 65.536F, 1e30F}) {
    EXPECT_EQ(depth_reading(metres), 0) << metres;
  }
}

}  // namespace
}  // namespace vesalius
