#include "synth/text/text_scanner.h"

#include <gmock/gmock.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::ThrowsMessage;

TEST(TextScanner, ReadsWordsNumbersAndLines) {
  TextScanner scan("one\t2 \r\n\n +3.5 4e-400 -1e-3", "t");
  EXPECT_EQ(scan.peek(), "one");
  EXPECT_EQ(scan.word("a word"), "one");
  EXPECT_FALSE(scan.at_line_end());
  EXPECT_EQ(scan.whole("a number", 0, 5), 2);
  EXPECT_TRUE(scan.at_line_end());
  EXPECT_FALSE(scan.at_end());
  EXPECT_EQ(scan.number("a number"), 3.5);
  EXPECT_EQ(scan.number("a number"), 0.0);
  EXPECT_EQ(scan.number("a number"), -1e-3);
  EXPECT_TRUE(scan.at_end());
  EXPECT_EQ(scan.peek(), "");
}

TEST(TextScanner, SkipsTheRestOfALine) {
  TextScanner scan("a b c\nd", "t");
  scan.word("a word");
  scan.skip_line();
  EXPECT_EQ(scan.word("a word"), "d");
  scan.skip_line();
  EXPECT_TRUE(scan.at_end());
}

TEST(TextScanner, NamesTheLineAndWhatWasExpected) {
  const auto number = [](const char* text) {
    return [text] {
      TextScanner scan(text, "t");
      scan.word("a word");
      scan.number("an angle");
    };
  };
  EXPECT_THAT(number("a\n\nb"), ThrowsMessage<Error>("t:3: expected an angle (a number up to 1e+06), found \"b\""));
  EXPECT_THAT(number("a nan"), ThrowsMessage<Error>("t:1: expected an angle (a number up to 1e+06), found \"nan\""));
  EXPECT_THAT(number("a -inf"), ThrowsMessage<Error>("t:1: expected an angle (a number up to 1e+06), found \"-inf\""));
  EXPECT_THAT(number("a 1e7"), ThrowsMessage<Error>("t:1: expected an angle (a number up to 1e+06), found \"1e7\""));
  EXPECT_THAT(number("a 1e999"),
              ThrowsMessage<Error>("t:1: expected an angle (a number up to 1e+06), found \"1e999\""));
  EXPECT_THAT(number("a 1x"), ThrowsMessage<Error>("t:1: expected an angle (a number up to 1e+06), found \"1x\""));
  EXPECT_THAT(number("a\n"), ThrowsMessage<Error>("t:2: expected an angle, found the end of the file"));
  TextScanner scan("7 x\x01", "t");
  EXPECT_THAT([&] { scan.whole("a count", 0, 6); },
              ThrowsMessage<Error>("t:1: expected a count (a whole number from 0 to 6), found \"7\""));
  EXPECT_THAT([&] { scan.expect("MOTION"); }, ThrowsMessage<Error>("t:1: expected MOTION, found \"x?\""));
}

TEST(TextScanner, ShowsUntrustedTextOnOneShortLine) {
  EXPECT_EQ(shown("a\nb\x1b[1m\xff"), "a?b?[1m?");
  EXPECT_EQ(shown(std::string(100, 'x')), std::string(40, 'x') + "...");
  EXPECT_EQ(in_quotes("a\tb"), "\"a?b\"");
}

TEST(TextScanner, ComparesWordsWithoutRegardToCase) {
  EXPECT_TRUE(same_word("Xrotation", "XROTATION"));
  EXPECT_FALSE(same_word("Xrotation", "Xrotatio"));
}

}  // namespace
}  // namespace vesalius::synth
