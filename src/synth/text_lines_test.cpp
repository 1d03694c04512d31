#include "synth/text_lines.h"

#include <gmock/gmock.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::StrEq;
using testing::ThrowsMessage;

const std::string kName = "file";

TEST(TextLines, CutsLinesIntoWords) {
  TextLines lines("a  b\t-1.5e1\r\n\n7 ", kName);
  ASSERT_TRUE(lines.next_line());
  EXPECT_EQ(lines.word(), "a");
  EXPECT_EQ(lines.word(), "b");
  EXPECT_FLOAT_EQ(lines.number(100.F), -15.F);
  EXPECT_EQ(lines.word(), "");
  ASSERT_TRUE(lines.next_line());
  EXPECT_EQ(lines.word(), "");
  ASSERT_TRUE(lines.next_line());
  EXPECT_EQ(lines.index(), 7U);
  EXPECT_FALSE(lines.next_line());
}

TEST(TextLines, NamesTheLineOfABadNumber) {
  for (const char* bad : {"nan", "inf", "-inf", "1e9", "1.5x", "x", ""}) {
    TextLines lines(bad, kName);
    const bool any = lines.next_line();
    EXPECT_EQ(any, *bad != '\0');
    EXPECT_THAT([&] { lines.number(100.F); },
                ThrowsMessage<Error>(StrEq(std::string("file:") + (any ? "1" : "0") + ": \"" + bad +
                                           "\": expected a number between -100 and 100")));
  }
  for (const char* bad : {"-1", "1.5", "99999999999", "x"}) {
    TextLines lines(bad, kName);
    lines.next_line();
    EXPECT_THROW(lines.index(), Error) << bad;
  }
}

TEST(TextLines, ShowsStrangersTextOnOneShortLine) {
  EXPECT_EQ(shown("a\nb\x1b[1m\xff"), "a?b?[1m?");
  EXPECT_EQ(shown(std::string(100, 'x')), std::string(40, 'x') + "...");
}

}  // namespace
}  // namespace vesalius::synth
