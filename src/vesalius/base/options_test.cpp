#include "vesalius/base/options.h"

#include <gmock/gmock.h>

#include <limits>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::ThrowsMessage;

constexpr OptionInfo kMetres{"m", 0.0, 2.0, "A length."};
constexpr OptionInfo kCount{"", 1.0, 25.0, "A count."};

void check_real(float value) { RangeCheck().option("grow.radius", value, kMetres); }
void check_count(int value) { RangeCheck().option("search.parts", value, kCount); }

TEST(RangeCheck, AcceptsTheRangeWithItsEnds) {
  for (const float value : {0.F, 1.F, 2.F}) EXPECT_NO_THROW(check_real(value));
  for (const int value : {1, 13, 25}) EXPECT_NO_THROW(check_count(value));
}

TEST(RangeCheck, AcceptsAnEndThatIsNoExactFloat) {
  float low = 0.1F;
  float high = 0.3F;
  EXPECT_NO_THROW(RangeCheck().option("x", low, {"", 0.1, 0.3, "A share."}));
  EXPECT_NO_THROW(RangeCheck().option("x", high, {"", 0.1, 0.3, "A share."}));
}

TEST(RangeCheck, NamesOptionValueRangeAndUnit) {
  EXPECT_THAT([] { check_real(2.5F); }, ThrowsMessage<UsageError>("option grow.radius is 2.5, expected 0 to 2 m"));
  EXPECT_THAT([] { check_count(0); }, ThrowsMessage<UsageError>("option search.parts is 0, expected 1 to 25"));
}

TEST(RangeCheck, RefusesValuesThatAreNotFinite) {
  EXPECT_THROW(check_real(std::numeric_limits<float>::quiet_NaN()), UsageError);
  EXPECT_THROW(check_real(std::numeric_limits<float>::infinity()), UsageError);
}

}  // namespace
}  // namespace vesalius
