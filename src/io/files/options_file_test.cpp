#include "io/files/options_file.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

struct TestOptions {
  float gap = 0.05F;
  int parts = 4;
  bool mode = false;
  float tiny = 1e-6F;
  std::string word = "plain";
};

VisitAll visit(TestOptions& o) {
  return [&o](OptionVisitor& v) {
    v.option("cluster.gap", o.gap, {"m", 0.0, 1.0, "A gap."});
    v.option("search.parts", o.parts, {"", 1, 25, "Parts."});
    v.option("search.mode", o.mode, {"", 0, 1, "A switch."});
    v.option("cluster.tiny", o.tiny, {"", 0.0, 1.0, "Small."});
    v.option("cluster.word", o.word, {"", 0, 0, "A word."});
  };
}

TestOptions parsed(const std::string& toml) {
  TestOptions options;
  parse_options(toml, "o.toml", visit(options));
  return options;
}

TEST(OptionsFile, SetsNamedOptionsAndKeepsTheOthers) {
  const TestOptions options = parsed("search.parts = 7\n");
  EXPECT_EQ(options.parts, 7);
  EXPECT_FLOAT_EQ(options.gap, 0.05F);
  EXPECT_FALSE(options.mode);
  EXPECT_EQ(parsed("").parts, 4);
}

TEST(OptionsFile, ReadsTablesAndDottedKeysAlike) {
  const TestOptions options = parsed("cluster.gap = 1\n[search]\nmode = true\nparts = 25\n");
  EXPECT_FLOAT_EQ(options.gap, 1.F);
  EXPECT_TRUE(options.mode);
  EXPECT_EQ(options.parts, 25);
}

TEST(OptionsFile, NamesLineAndReasonOfErrors) {
  const auto parse = [](const char* text) { return [text] { parsed(text); }; };
  EXPECT_THAT(parse("\nserach.parts = 7"),
              ThrowsMessage<Error>("o.toml:2: no option is called \"serach.parts\"; did you mean \"search.parts\"?"));
  EXPECT_THAT(parse("parts = 7"), ThrowsMessage<Error>(HasSubstr("did you mean \"search.parts\"?")));
  EXPECT_THAT(parse("quite-different = 7"), ThrowsMessage<Error>("o.toml:1: no option is called \"quite-different\""));
  EXPECT_THAT(parse("search.parts = 26"),
              ThrowsMessage<Error>("o.toml:1: option search.parts is 26, expected 1 to 25"));
  EXPECT_THAT(parse("search.parts = 4.5"), ThrowsMessage<Error>("o.toml:1: search.parts: expected a whole number"));
  EXPECT_THAT(parse("search.parts = 4294967300"), ThrowsMessage<Error>(HasSubstr("expected a whole number")));
  EXPECT_THAT(parse("cluster.gap = nan"), ThrowsMessage<Error>(StartsWith("o.toml:1: option cluster.gap is nan")));
  EXPECT_THAT(parse("cluster.gap = \"1\""), ThrowsMessage<Error>("o.toml:1: cluster.gap: expected a number"));
  EXPECT_THAT(parse("search.mode = 1"), ThrowsMessage<Error>("o.toml:1: search.mode: expected true or false"));
  EXPECT_THAT(parse("cluster.word = 1"), ThrowsMessage<Error>("o.toml:1: cluster.word: expected a text in quotes"));
  EXPECT_THAT(parse("search = 1"), ThrowsMessage<Error>(HasSubstr("no option is called \"search\"")));
  EXPECT_THAT(parse("x = [\n"), ThrowsMessage<Error>(HasSubstr("not valid TOML")));
}

TEST(OptionsFile, WritesWhatItReads) {
  TestOptions written{.gap = 0.1F, .parts = 9, .mode = true, .tiny = 3e-7F, .word = "a \"b\" \\ c"};
  const TestOptions again = parsed(options_toml(visit(written)));
  EXPECT_EQ(again.gap, written.gap);
  EXPECT_EQ(again.parts, written.parts);
  EXPECT_EQ(again.mode, written.mode);
  EXPECT_EQ(again.tiny, written.tiny);
  EXPECT_EQ(again.word, written.word);
}

TEST(OptionsFile, DescribesEveryOption) {
  TestOptions options;
  options.gap = 1.F;
  EXPECT_THAT(options_toml(visit(options)),
              StartsWith("# A gap. (0 to 1 m)\ncluster.gap = 1.0\n\n# Parts. (1 to 25)\nsearch.parts = 4\n"));
}

TEST(OptionsFile, KeepsDetectorOptionsInAFile) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "o.toml";
  DetectOptions changed;
  changed.search.min_parts = 9;
  changed.cluster.max_gap_m = 0.125F;
  write_options([&](OptionVisitor& v) { visit_options("", changed, v); }, path);
  DetectOptions again;
  const VisitAll all = [&](OptionVisitor& v) { visit_options("", again, v); };
  read_options(path, all);
  EXPECT_EQ(again.search.min_parts, 9);
  EXPECT_EQ(again.cluster.max_gap_m, 0.125F);
  EXPECT_EQ(options_toml(all), options_toml([&](OptionVisitor& v) { visit_options("", changed, v); }));
  RangeCheck check;
  EXPECT_NO_THROW(visit_options("", again, check)) << "defaults lie in their ranges";
}

TEST(OptionText, SetsWhatItLists) {
  TestOptions written{.gap = 0.1F, .parts = 9, .mode = true, .tiny = 3e-7F, .word = "a \"b\" \\ c"};
  TestOptions again;
  for (const OptionText& option : list_options(visit(written))) set_option(option.name, option.value, visit(again));
  EXPECT_EQ(options_toml(visit(again)), options_toml(visit(written)));
  EXPECT_EQ(list_options(visit(again)).size(), 5U);
  EXPECT_EQ(list_options(visit(again))[1].kind, OptionKind::whole_number);
}

TEST(OptionText, KeepsTheValueWhereATextDoesNotFit) {
  TestOptions options;
  const auto set = [&](const char* name, const char* text) {
    return [&options, name, text] { set_option(name, text, visit(options)); };
  };
  EXPECT_THAT(set("search.parts", "26"), ThrowsMessage<UsageError>("option search.parts is 26, expected 1 to 25"));
  EXPECT_THAT(set("search.parts", "4.5"),
              ThrowsMessage<UsageError>("option search.parts: found \"4.5\", expected a whole number"));
  EXPECT_THAT(set("cluster.gap", "0.1 m"), ThrowsMessage<UsageError>(HasSubstr("expected a number")));
  EXPECT_THAT(set("cluster.gap", ""), ThrowsMessage<UsageError>(HasSubstr("expected a number")));
  EXPECT_THAT(set("cluster.gap", "nan"), ThrowsMessage<UsageError>(HasSubstr("option cluster.gap is nan")));
  EXPECT_THAT(set("search.mode", "yes"), ThrowsMessage<UsageError>(HasSubstr("expected true or false")));
  EXPECT_THAT(set("serach.parts", "4"),
              ThrowsMessage<UsageError>("no option is called \"serach.parts\"; did you mean \"search.parts\"?"));
  TestOptions defaults;
  EXPECT_EQ(options_toml(visit(options)), options_toml(visit(defaults)));
}

TEST(NearestName, FindsOnlySimilarNames) {
  const std::vector<std::string> known = {"search.min-parts", "search.max-total-error", "smooth.window"};
  EXPECT_EQ(nearest_name("search.min-part", known), "search.min-parts");
  EXPECT_EQ(nearest_name("window", known), "smooth.window");
  EXPECT_EQ(nearest_name("colour", known), "");
}

}  // namespace
}  // namespace vesalius
