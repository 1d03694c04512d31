#include <gmock/gmock.h>

#include "cli/train/train_report.h"

namespace vesalius::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ConfusionSvg, ShowsTheSharesOfEachRow) {
  Confusion confusion(2);
  confusion.at(0, 0) = 3;
  confusion.at(0, 1) = 1;
  const std::string svg = confusion_svg(confusion, {"l_hand", "back<ground"});
  EXPECT_THAT(svg, HasSubstr(">75<"));
  EXPECT_THAT(svg, HasSubstr(">25<"));
  EXPECT_THAT(svg, HasSubstr(">l_hand<"));
  EXPECT_THAT(svg, HasSubstr("back&lt;ground"));
  EXPECT_THAT(svg, Not(HasSubstr("nan"))) << "the second class has no sample";
  EXPECT_THAT(svg, HasSubstr("fill=\"#ffffff\"/>")) << "a share of 0 is white";
}

}  // namespace
}  // namespace vesalius::cli
