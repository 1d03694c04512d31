#include "console/text_sink.h"

#include <gtest/gtest.h>

namespace vesalius::cli {
namespace {

TEST(Escaped, KeepsControlCharactersFromTheTerminal) {
  EXPECT_EQ(escaped("a\x1b[31mred\x07\x7f\r"), "a\\x1b[31mred\\x07\\x7f\\x0d");
  EXPECT_EQ(escaped("csi \xc2\x9b"
                    "31m"),
            "csi \\xc2\\x9b"
            "31m")
      << "a control character of UTF-8";
  EXPECT_EQ(escaped("raw \x9b"
                    "31m"),
            "raw \\x9b"
            "31m")
      << "and a single byte of 8-bit terminals";
}

TEST(Escaped, LeavesPlainTextUnchanged) {
  EXPECT_EQ(escaped("two\nlines"), "two\nlines");
  EXPECT_EQ(escaped("Füße ✓ 人 \xf0\x9f\x99\x82"), "Füße ✓ 人 \xf0\x9f\x99\x82") << "their bytes include 0x80 to 0x9f";
}

TEST(OneLine, TurnsControlCharactersIntoSpaces) { EXPECT_EQ(one_line("one\ntwo\x1b[2J\xc2\x9b✓"), "one two [2J ✓"); }

}  // namespace
}  // namespace vesalius::cli
