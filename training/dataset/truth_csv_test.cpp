#include "dataset/truth_csv.h"

#include "dataset/open_truth.h"
#include "io/files/test_files.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(CsvTable, GivesCellsByColumn) {
  const CsvTable table = CsvTable::parse(
      "\xef\xbb\xbf"
      "a,b,c\r\n1,,x y\r\n\r\n-2,0.5,\n",
      "t.csv");
  ASSERT_EQ(table.rows(), 2U);
  EXPECT_TRUE(table.has("b"));
  EXPECT_FALSE(table.has("d"));
  EXPECT_EQ(table.cell(0, table.column("c")), "x y");
  EXPECT_EQ(table.cell(1, table.column("c")), "");
  EXPECT_EQ(table.integer(1, table.column("a"), -5, 5), -2);
  EXPECT_DOUBLE_EQ(table.number(1, table.column("b")), 0.5);
  EXPECT_EQ(table.place(1), "t.csv:4");
}

TEST(CsvTable, MayHaveNoRows) { EXPECT_EQ(CsvTable::parse("a,b", "t.csv").rows(), 0U); }

TEST(CsvTable, NamesTheLineOfErrors) {
  const auto error = [](const std::string& text) { return test::error_of([&] { CsvTable::parse(text, "t.csv"); }); };
  EXPECT_EQ(error(""), "t.csv: empty, expected a header with the columns' names");
  EXPECT_EQ(error("a,b\n1,2\n1\n"), "t.csv:3: 1 cells, expected 2 as in the header");
  EXPECT_EQ(error("a,b,a\n"), "t.csv: the column \"a\" comes twice");
  const CsvTable table = CsvTable::parse("a\nx\n1.5\ninf\n1e999\n 3\n", "t.csv");
  EXPECT_EQ(test::error_of([&] { table.number(0, 0); }), "t.csv:2: column a: \"x\", expected a finite number");
  EXPECT_THAT(test::error_of([&] { table.integer(1, 0, 0, 9); }),
              HasSubstr("\"1.5\", expected a whole number from 0 to 9"));
  for (const std::size_t row : {2U, 3U, 4U}) {
    EXPECT_THAT(test::error_of([&] { table.number(row, 0); }), HasSubstr("expected a finite number"));
  }
  EXPECT_EQ(test::error_of([&] { table.column("b"); }), "t.csv: no column \"b\" in the header");
  EXPECT_THAT(test::error_of([] { CsvTable::read("/nowhere/t.csv"); }), StartsWith("/nowhere/t.csv: "));
}

TEST(CsvTable, ShowsACellOnOneLineInErrors) {
  const CsvTable table = CsvTable::parse("a\n\x1b[31m\x01" + std::string(500, 'z') + "\n", "t.csv");
  const std::string error = test::error_of([&] { table.number(0, 0); });
  EXPECT_LT(error.size(), 150U);
  EXPECT_THAT(error, HasSubstr("?[31m?zzz"));
}

HeadingTable parsed(const std::string& text) { return HeadingTable::parse(CsvTable::parse(text, "h.csv")); }

TEST(Headings, AreReadBySetAndFrame) {
  const HeadingTable table = parsed("set,frame,heading\nroom,a,front\nroom,b,back\nhall,a,side\nhall,b,\n");
  EXPECT_EQ(table.of("room", "a"), Heading::front);
  EXPECT_EQ(table.of("room", "b"), Heading::back);
  EXPECT_EQ(table.of("hall", "a"), Heading::side);
  EXPECT_FALSE(table.of("hall", "b"));
  EXPECT_FALSE(table.of("attic", "a"));
}

TEST(Headings, NameTheLineThatCannotBeUsed) {
  EXPECT_THAT(test::error_of([] { parsed("set,frame,heading\nroom,a,left\n"); }),
              HasSubstr("h.csv:2: column heading: \"left\", expected front, side, back or nothing"));
  EXPECT_THAT(test::error_of([] { parsed("set,frame,heading\nroom,a,back\nroom,a,back\n"); }),
              HasSubstr("h.csv:3: frame a of room comes twice"));
  EXPECT_THAT(test::error_of([] { parsed("set,frame\nroom,a\n"); }), HasSubstr("no column \"heading\""));
}

TEST(Headings, ComeFromTheTableOfFramesOrFromOneBeside) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a", "b", "c"}) {
    test::put(folder / "depth/" + name + ".png", encode_png(DepthImage(6, 4, 1000)));
  }
  test::put(folder / "frames.csv", "frame,people,heading\na,1,side\nb,1,\nc,1,front\n");
  test::put(folder / "meta.json", R"({"fx": 5, "fy": 5, "cx": 2.5, "cy": 1.5, "width": 6, "height": 4})");
  const auto frames = with_headings(open_truth(folder.path()), parsed("set,frame,heading\nroom,c,back\n"), "room");
  EXPECT_EQ(frames->size(), 3);
  EXPECT_EQ(frames->next()->truth.heading, Heading::side);
  EXPECT_FALSE(frames->next()->truth.heading);
  EXPECT_EQ(frames->next()->truth.heading, Heading::back);
  EXPECT_FALSE(frames->next());
}

}  // namespace

}  // namespace vesalius
