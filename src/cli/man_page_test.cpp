#include "cli/man_page.h"

#include <gmock/gmock.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/program.h"
#include "console/detector_flags.h"

namespace vesalius::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string text_of(const CLI::App& program, const std::string& name) {
  const std::vector<ManPage> pages = man_pages(program);
  const auto found = std::ranges::find(pages, name, &ManPage::name);
  return found == pages.end() ? "no page " + name : found->text;
}

TEST(ManPage, SaysWhatAnOptionTakes) {
  CLI::App app;
  app.name("tool");
  CLI::App* cut = app.add_subcommand("cut", "Cut things");
  int count = 3;
  std::string kind;
  std::vector<std::string> files;
  cut->add_option("FILE", files, "What to cut")->required();
  cut->add_option("-c,--count", count, "Pieces")->type_name("N")->check(CLI::Range(1, 9))->capture_default_str();
  cut->add_option("--kind", kind, "How")->type_name("WORD")->check(CLI::IsMember({"thin", "thick"}));
  cut->add_option("--to", kind, "Where")->type_name("HOST:PORT")->needs("--kind");
  const std::string page = text_of(app, "tool-cut");
  EXPECT_THAT(page, HasSubstr(".SH NAME\ntool\\-cut \\- cut things\n"));
  EXPECT_THAT(page, HasSubstr(".SH SYNOPSIS\n\\fBtool cut\\fR [\\fIOPTION\\fR]... \\fIFILE\\fR...\n"));
  EXPECT_THAT(page, HasSubstr(".SH ARGUMENTS\n.TP\n\\fIFILE\\fR ...\nWhat to cut. Required.\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-c\\fR, \\fB\\-\\-count\\fR \\fIN\\fR\nPieces. From 1 to 9. Default: 3.\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-kind\\fR \\fIWORD\\fR\nHow. Of: thin, thick.\n"));
  EXPECT_THAT(page, HasSubstr("\\fIHOST:PORT\\fR\nWhere. Needs \\fB\\-\\-kind\\fR.\n"));
  EXPECT_THAT(page, HasSubstr("\\fBtool\\fR(1)\n"));
}

TEST(ManPage, KeepsRoffFromReadingTexts) {
  CLI::App app;
  app.name("tool");
  app.description(R"(Reads C:\new and 'words')");
  app.footer(
      "\nA paragraph with `code -x`.\n.hidden begins with a dot.\n\nExamples:\n  'a' ^ ~/.b\n  .c\n\nExit codes: 0 "
      "done.");
  const std::string page = text_of(app, "tool");
  EXPECT_THAT(page, HasSubstr("Reads C:\\(rsnew and \\(aqwords\\(aq.\n"));
  EXPECT_THAT(page, HasSubstr(".PP\nA paragraph with \\fBcode \\-x\\fR.\n\\&.hidden begins with a dot.\n"));
  EXPECT_THAT(page, HasSubstr(".SH EXAMPLES\n.nf\n\\(aqa\\(aq \\(ha \\(ti/.b\n\\&.c\n.fi\n"));
  EXPECT_THAT(page, HasSubstr(".SH EXIT STATUS\n0 done.\n"));
}

TEST(ManPage, HoldsTheOptionsThatHelpLeavesOut) {
  CLI::App app;
  app.name("tool");
  CLI::App* find = app.add_subcommand("find", "Find");
  const DetectorFlags flags(*find);
  EXPECT_THAT(find->help(), Not(HasSubstr("--search.min-parts")));
  const std::string page = text_of(app, "tool-find");
  const std::size_t at = page.find("\\fB\\-\\-search.min\\-parts\\fR");
  ASSERT_NE(at, std::string::npos);
  EXPECT_THAT(page.substr(at, 200), HasSubstr("Default: " + std::to_string(DetectOptions{}.search.min_parts) + "."));
  EXPECT_THAT(page, HasSubstr("\\fB\\-\\-smooth.mode\\fR, \\fB\\-\\-no\\-smooth.mode\\fR\n"));
}

TEST(ManPage, EveryCommandHasOneWithoutWhatIsOfTheProgram) {
  CLI::App app;
  describe_program(app);
  const std::vector<ManPage> pages = man_pages(app);
  EXPECT_EQ(pages.front().name, "vesalius");
  EXPECT_GT(pages.size(), app.get_subcommands({}).size());
  for (const ManPage& page : pages) {
    EXPECT_THAT(page.text, HasSubstr(".SH EXIT STATUS\n")) << page.name;
    // CLI11 gives a command without a footer that of the program.
    const bool has_its_examples = page.text.find("everything about one command") != std::string::npos;
    EXPECT_EQ(has_its_examples, page.name == "vesalius") << page.name;
  }
}

}  // namespace
}  // namespace vesalius::cli
