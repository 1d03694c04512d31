#include "report/document.h"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "io/files/data_file.h"
#include "io/files/test_files.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const std::string kPng = "\x89PNG\r\n\x1a\n";

/// Returns what the page is given to show.
json shown(const std::string& page) {
  const std::string mark = "id=\"report\">";
  const std::size_t begin = page.find(mark) + mark.size();
  return json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST(Document, IsOnePageWithAllThatIsShown) {
  Document document("A & B");
  document.heading(3, "x < y");
  document.paragraph("</script><script>alert(1)</script>");
  document.preformatted("run this\n  and that");
  document.table({"n"}, {{"1"}, {""}});
  document.picture(kPng, "the \"worst\"");
  const std::string page = document.html();
  EXPECT_THAT(page, StartsWith("<!doctype html>"));
  EXPECT_THAT(page, Not(HasSubstr("alert(1)</script>")));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));  // opens offline
  EXPECT_THAT(page, HasSubstr("The MIT License (MIT)")) << "of the plot library";
  EXPECT_EQ(shown(page), json::parse(R"({"title": "A & B", "blocks": [
    {"kind": "heading", "level": 3, "text": "x < y"},
    {"kind": "paragraph", "text": "</script><script>alert(1)</script>"},
    {"kind": "preformatted", "text": "run this\n  and that"},
    {"kind": "table", "rows": [["n"], ["1"], [""]]},
    {"kind": "picture", "caption": "the \"worst\"", "png": "iVBORw0KGgo="}]})"));
}

TEST(Document, GivesPlotsAsNumbers) {
  Document document("r");
  document.plot({"Curve", "x", "y", {{"a", {{1.0, 0.5}, {2.0, kNaN}}}, {"b", {}}}, {}, std::pair{0.0, 1.0}, true});
  document.plot({"Nothing", "x", "y", {{"a", {{kNaN, 0.5}, {2.0, kNaN}}}}});
  document.matrix({"Confusion", {"hand", "foot"}, {{0.75, 0.25}, {0.0, 1.0}}});
  EXPECT_EQ(shown(document.html()).at("blocks"), json::parse(R"([
    {"kind": "plot", "caption": "Curve", "x": "x", "y": "y", "log_x": true, "x_range": null, "y_range": [0.0, 1.0],
     "series": [{"name": "a", "points": [[1.0, 0.5], [2.0, null]]}, {"name": "b", "points": []}]},
    {"kind": "matrix", "caption": "Confusion", "names": ["hand", "foot"], "shares": [[0.75, 0.25], [0.0, 1.0]]}])"));
}

TEST(Document, HoldsPicturesInBase64AsInRfc4648) {
  for (const auto& [bytes, text] : {std::pair{"", "iVBORw=="}, {"f", "iVBOR2Y="}, {"fo", "iVBOR2Zv"}}) {
    Document document("r");
    document.picture("\x89PNG" + std::string(bytes), "");
    EXPECT_EQ(shown(document.html()).at("blocks").at(0).at("png"), text);
  }
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
  EXPECT_THAT([&] { document.picture("<svg>", "x"); }, ThrowsMessage<Error>(HasSubstr("x: no PNG")));
  EXPECT_THAT(
      [&] {
        document.matrix({"m", {"a", "b"}, {{1.0}, {0.0}}});
      },
      ThrowsMessage<Error>(HasSubstr("m: expected 2 rows of as many shares")));
  EXPECT_THAT(
      [&] {
        document.bars({"m", {"a", "b"}, {{"s", {1.0}}}});
      },
      ThrowsMessage<Error>(HasSubstr("m: expected 2 shares of s")));
}

TEST(Document, IsWrittenIntoItsFolder) {
  const test::TemporaryFolder folder;
  make_report_folder(folder / "a/b");
  write_report_page(Document("r"), folder / "a/b");
  EXPECT_EQ(read_file(folder / "a/b/report.html"), Document("r").html());
  EXPECT_THAT([&] { make_report_folder(folder / "a/b/report.html/c"); },
              ThrowsMessage<Error>(HasSubstr("report.html/c: cannot be made")));
}

}  // namespace
}  // namespace vesalius
