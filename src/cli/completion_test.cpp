#include "cli/completion.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <fstream>
#include <memory>

#include "cli/commands.h"

namespace vesalius::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void describe(CLI::App& app) {
  app.name("vesalius");
  app.set_version_flag("--version", "0");
  add_detect(app);
  add_info(app);
  add_completion(app);
}

std::string output_of(const std::string& command) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) text += buffer.data();
  return text;
}

class Completion : public testing::Test {
 protected:
  Completion() { describe(app); }

  std::string write(const std::string& name, const std::string& script) const {
    const std::string path =
        testing::TempDir() + "/vesalius_completion_test_" + std::to_string(::getpid()) + "_" + name;
    std::ofstream(path) << script;
    return path;
  }
  /// Returns what bash would offer for the last of these words.
  std::string bash_offers(const std::string& words, int index) const {
    const std::string path = write("bash", bash_completion(app));
    return output_of("bash -c 'source " + path + "; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(index) +
                     "; _vesalius; echo \" ${COMPREPLY[*]} \"' 2>&1");
  }

  CLI::App app;
};

TEST_F(Completion, OffersCommandsFlagsAndChoicesInBash) {
  if (output_of("command -v bash").empty()) GTEST_SKIP() << "needs bash";
  EXPECT_EQ(bash_offers("vesalius de", 1), " detect \n");
  EXPECT_THAT(bash_offers("vesalius \"\"", 1),
              AllOf(HasSubstr(" detect "), HasSubstr(" info "), HasSubstr(" --help ")));
  EXPECT_EQ(bash_offers("vesalius detect --js", 2), " --json \n");
  EXPECT_EQ(bash_offers("vesalius detect --search.min-p", 2), " --search.min-parts \n");
  EXPECT_EQ(bash_offers("vesalius detect --save o", 3), " overlay \n");
  EXPECT_THAT(bash_offers("vesalius info --", 2), AllOf(HasSubstr(" --json "), Not(HasSubstr("--save"))));
  EXPECT_THAT(bash_offers("vesalius completion b", 2), HasSubstr(" bash "));
}

TEST_F(Completion, EscapesQuotesInTheScript) {
  CLI::App odd;
  odd.name("odd");
  odd.add_subcommand("x", "it's: [odd]")->add_flag("--y")->description("isn't [it]: so");
  EXPECT_EQ(output_of("bash -n " + write("odd", bash_completion(odd)) + " 2>&1"), "");
}

}  // namespace
}  // namespace vesalius::cli
