#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <system_error>

#include "cli/commands.h"
#include "cli/man_page.h"
#include "io/files/atomic_file.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

void write_pages(const CLI::App& program, const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(fmt::format("{}: cannot create folder: {}", folder, error.message()));
  for (const ManPage& page : man_pages(program)) {
    write_file_atomically((fs::path(folder) / (page.name + ".1")).string(), page.text);
  }
}

}  // namespace

void add_man(CLI::App& program) {
  CLI::App* command = program.add_subcommand("man", "Write the pages of the manual, one for each command");
  const auto folder = std::make_shared<std::string>();
  command->add_option("DIR", *folder, "Folder for them, created if missing")->required();
  command->footer(R"(
An installed vesalius includes these pages.

Examples:
  vesalius man pages/
  man -l pages/vesalius-detect.1)");
  command->callback([folder, &program] { write_pages(program, *folder); });  // the option writes into `folder`
}

}  // namespace vesalius::cli
