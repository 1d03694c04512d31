#include "view/run_lengths.h"

#include <gmock/gmock.h>

#include "vesalius/base/random.h"
#include "view/test_runs.h"

namespace vesalius {
namespace {

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
