#include "dataset/truth_headings.h"

#include "dataset/open_truth.h"
#include "io/files/test_files.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using ::testing::HasSubstr;

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
