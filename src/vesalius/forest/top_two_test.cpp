#include "vesalius/forest/top_two.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/base/test_targets.h"

namespace vesalius {
namespace {

TopTwo plain_top_two(const std::uint16_t* sums, int classes) {
  const std::uint16_t* first = std::max_element(sums, sums + classes);
  TopTwo top;
  if (*first == 0) return top;
  top.first = *first;
  top.best = static_cast<std::uint16_t>(first - sums);
  for (const std::uint16_t* s = sums; s != sums + classes; ++s) {
    if (s != first) top.second = std::max(top.second, *s);
  }
  return top;
}

TEST(TopTwo, AgreeWithThePlainSearchOnEveryInstructionSet) {
  Random random(3);
  constexpr int kPixels = 500;
  for (const int classes : {1, 2, 7, 8, 15, 16, 17, 25, 26, 32, 40}) {
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
    for_each_target([&](const char* target) {
      std::vector<TopTwo> top(kPixels, TopTwo{9, 9, 9});
      find_top_two(sums.data(), stride, classes, skip.data(), kPixels, top.data());
      for (std::size_t i = 0; i < kPixels; ++i) {
        const TopTwo expected = skip[i] != 0 ? TopTwo() : plain_top_two(sums.data() + i * stride, classes);
        ASSERT_EQ(top[i].first, expected.first) << target << ' ' << classes << " classes, pixel " << i;
        ASSERT_EQ(top[i].second, expected.second) << target << ' ' << classes << " classes, pixel " << i;
        ASSERT_EQ(top[i].best, expected.best) << target << ' ' << classes << " classes, pixel " << i;
      }
    });
  }
}

}  // namespace
}  // namespace vesalius
