#include "vesalius/choose_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "vesalius/for_each_target.h"
#include "vesalius/image.h"
#include "vesalius/random.h"

namespace vesalius {
namespace {

struct Best {
  std::uint8_t label = kBackground, unsure = 0;
};

Best plain_best(const std::uint16_t* sums, int classes, std::uint32_t margin) {
  const std::uint16_t* first = std::max_element(sums, sums + classes);
  if (*first == 0) return {};
  std::uint32_t second = 0;
  for (const std::uint16_t* s = sums; s != sums + classes; ++s) {
    if (s != first) second = std::max<std::uint32_t>(second, *s);
  }
  return {static_cast<std::uint8_t>(first - sums), static_cast<std::uint8_t>(second > 0 && *first - second < margin)};
}

TEST(ChooseKernel, IsThePlainChoiceOnEveryInstructionSet) {
  Random random(3);
  constexpr int kPixels = 500;
  for (const int classes : {16, 17, 25, 26, 32, 40}) {
    const auto stride = static_cast<std::size_t>(classes) + random.below(2);
    std::vector<std::uint16_t> sums(stride * kPixels);
    for (std::uint16_t& s : sums) {  // ties, zeros, all of 16 bits
      const std::uint32_t kind = random.below(8);
      s = static_cast<std::uint16_t>(kind < 4   ? random.below(4)
                                     : kind < 7 ? random.below(2041)
                                                : 65000 + random.below(536));
    }
    for (std::size_t i = 0; i < 40 * stride; ++i)
      sums[i] = static_cast<std::uint16_t>(random.below(2) * random.below(2));
    std::fill_n(sums.begin(), stride, std::uint16_t{0});
    std::vector<std::uint8_t> skip(kPixels);
    for (std::uint8_t& s : skip) s = random.below(5) == 0 ? 1 : 0;
    for (const std::uint32_t margin : {0U, 2U, 102U, 65535U}) {
      for_each_target([&](const char* target) {
        ASSERT_TRUE(best_classes_fit(classes));
        std::vector<std::uint8_t> best(kPixels, 9), unsure(kPixels, 9);
        best_classes(sums.data(), stride, classes, skip.data(), kPixels, margin, best.data(), unsure.data());
        for (std::size_t i = 0; i < kPixels; ++i) {
          const Best expected = skip[i] != 0 ? Best() : plain_best(sums.data() + i * stride, classes, margin);
          ASSERT_EQ(best[i], expected.label) << target << ' ' << classes << " classes, pixel " << i;
          ASSERT_EQ(unsure[i], expected.unsure) << target << ' ' << classes << " classes, pixel " << i;
        }
      });
    }
  }
}

}  // namespace
}  // namespace vesalius
