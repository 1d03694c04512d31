#include "report/document.h"

#include <gmock/gmock.h>

#include "report/escape_text.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

const std::string kSvg = "<svg></svg>";
const std::string kPng = "\x89PNG\r\n\x1a\n";

TEST(EscapeText, EncodesBase64AsInRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(EscapeText, TurnsHtmlMarkupIntoText) {
  EXPECT_EQ(escape_html("<a href=\"x\">&</a>"), "&lt;a href=&quot;x&quot;&gt;&amp;&lt;/a&gt;");
  EXPECT_EQ(escape_html(std::string("a\x1b[0m\n\tb")), "a [0m\n\tb");
}

TEST(EscapeText, TurnsMarkdownMarkupIntoText) {
  EXPECT_EQ(escape_markdown("a|b *c* `d` [e](f) <g>"), "a\\|b \\*c\\* \\`d\\` \\[e\\](f) \\<g\\>");
  EXPECT_EQ(escape_markdown("# 1"), "\\# 1");
  EXPECT_EQ(escape_markdown("- 1"), "\\- 1");
  EXPECT_EQ(escape_markdown("-1"), "-1");
  EXPECT_EQ(escape_markdown("12. x"), "12\\. x");
  EXPECT_EQ(escape_markdown("0.5 of 1.5"), "0.5 of 1.5");
  EXPECT_EQ(escape_markdown("alina_wave _x_"), "alina_wave \\_x\\_");
  EXPECT_EQ(escape_markdown("    two\nlines"), "two lines");
}

TEST(Document, IsWrittenAsMarkdown) {
  Document document("Report");
  document.heading(2, "Sets");
  document.paragraph("All of it.");
  document.table({"set", "frames"}, {{"a|b", "75"}, {"c", "-1.5"}});
  document.svg("curve one", kSvg, "A curve");
  document.preformatted("run ``` this\nand that");
  EXPECT_EQ(document.markdown("pictures"),
            "# Report\n\n## Sets\n\nAll of it.\n\n"
            "| set | frames |\n|---|---:|\n| a\\|b | 75 |\n| c | -1.5 |\n\n"
            "![A curve](<pictures/curve_one.svg>)\n\n*A curve*\n\n"
            "````\nrun ``` this\nand that\n````\n");
  EXPECT_THAT(document.markdown(), HasSubstr("(<curve_one.svg>)"));
}

TEST(Document, IsOnePageOfHtmlWithItsPictures) {
  Document document("A & B");
  document.heading(3, "x < y");
  document.table({"n"}, {{"1"}, {""}});
  document.picture("frame", kPng, "the \"worst\"");
  const std::string page = document.html();
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(page, HasSubstr("<h1>A &amp; B</h1>"));
  EXPECT_THAT(page, HasSubstr("<h3>x &lt; y</h3>"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number\">1</td>"));
  EXPECT_THAT(page, HasSubstr("alt=\"the &quot;worst&quot;\" src=\"data:image/png;base64," + base64(kPng) + "\""));
  EXPECT_THAT(page, Not(HasSubstr("http")));  // opens offline
}

TEST(Document, GivesPicturesSafeUniqueFileNames) {
  Document document("r");
  document.svg("../a b", kSvg, "");
  document.svg(".._a_b", kSvg, "");
  document.picture("../a b", kPng, "");
  document.svg("", kSvg, "");
  std::vector<std::string> files;
  for (const Document::Picture& picture : document.pictures()) files.push_back(picture.file);
  EXPECT_THAT(files, testing::ElementsAre("___a_b.svg", "___a_b-2.svg", "___a_b.png", "picture.svg"));
}

TEST(Document, RefusesInvalidTablesHeadingsAndPictures) {
  Document document("r");
  EXPECT_THAT([&] { document.heading(1, "x"); }, ThrowsMessage<Error>(HasSubstr("level 1, expected 2 to 6")));
  EXPECT_THAT(
      [&] {
        document.table({"a", "b"}, {{"1", "2"}, {"3"}});
      },
      ThrowsMessage<Error>(HasSubstr("row 1 of a table has 1 cells, expected 2")));
  EXPECT_THAT([&] { document.table({}, {}); }, ThrowsMessage<Error>(HasSubstr("without columns")));
  EXPECT_THAT([&] { document.picture("x", kSvg, ""); }, ThrowsMessage<Error>(HasSubstr("x: no PNG")));
  EXPECT_THAT([&] { document.svg("x", kPng, ""); }, ThrowsMessage<Error>(HasSubstr("x: no SVG")));
}

}  // namespace
}  // namespace vesalius
