#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "console/interrupts.h"
#include "console/satellites.h"
#include "console/status_line.h"
#include "console/text_sink.h"
#include "downloads/assets.h"
#include "io/files/plain_text.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

constexpr std::uint64_t kKilobyte = 1000;

struct Arguments {
  std::vector<std::string> names;
  std::string mirror;
  std::string folder;
  bool list = false;
  bool quiet = false;
};

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", double(bytes) / 1e6); }

void print_list(const std::string& folder) {
  for (const AssetPackage& package : asset_packages()) {
    print(fmt::format("{}: {}, {}, {}\n", package.name, counted(std::ssize(package.files), "file"),
                      megabytes(package.bytes()),
                      has_assets(package, folder) ? "in " + folder + "/" + package.name : "not fetched"));
    print(fmt::format("  licence: {}\n  credit: {}\n  see: {}\n", package.licence, package.credit, package.page));
    for (const AssetSource& source : package.sources) {
      print(fmt::format("  made of {}, {}, of {}\n    licence: {}\n    credit: {}\n",
                        counted(std::ssize(source.originals), "file"), megabytes(source.bytes()), source.home,
                        source.licence, source.credit));
    }
  }
}

void install(const AssetPackage& package, const std::string& folder, const Arguments& arguments) {
  Progress progress(-1, !arguments.quiet, "kB", "kB");
  const InstallWatch watch = [&](std::uint64_t done, std::uint64_t total) {
    if (total > 0) progress.set(int(done / kKilobyte), int(total / kKilobyte));
    return !interrupted();
  };
  const InstallReport report = install_assets(package, folder, arguments.mirror, watch);
  progress.clear();
  if (arguments.quiet) return;
  say(fmt::format("{}/{}: {} fetched, {} were there", folder, package.name, counted(report.fetched, "file"),
                  report.kept));
  if (report.fetched > 0) say(fmt::format("  licence: {}; credit: {}", package.licence, package.credit));
}

void run(const Arguments& arguments) {
  const std::string folder = arguments.folder.empty() ? assets_folder() : arguments.folder;
  if (arguments.list) {
    print_list(folder);
    return;
  }
  std::vector<const AssetPackage*> wanted;
  for (const std::string& name : arguments.names) wanted.push_back(&asset_package(name));
  if (arguments.names.empty()) {
    for (const AssetPackage& package : asset_packages()) wanted.push_back(&package);
  }
  watch_interrupts();
  for (const AssetPackage* package : wanted) install(*package, folder, arguments);
}

void add_assets(CLI::App& program) {
  CLI::App* command = program.add_subcommand("assets", "Fetch the bodies and motions that `vesalius synth` can use");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("NAME", arguments->names, "Packages (makehuman, mocap or motions); all if none is named");
  command->add_option("--mirror", arguments->mirror,
                      "Folder or address (http://, https://, file://) that holds NAME.tar.xz or the files below NAME/");
  command->add_option("--dir", arguments->folder,
                      "Folder for them (default: $VESALIUS_ASSETS, else vesalius in $XDG_DATA_HOME or ~/.local/share)");
  command->add_flag("--list", arguments->list,
                    "Only list the packages: size, licence, credit and whether each is there");
  command->add_flag("-q,--quiet", arguments->quiet, "Print errors only");
  command->footer(R"(
Each file gets its name only if its SHA-256 is right. Running the command again fetches missing files.
The motions are fetched as they were published (207 MB) and thinned to 30 frames a second, unless a mirror has them so.

Examples:
  vesalius assets motions
  vesalius assets --mirror /media/usb/assets --dir ~/vesalius-assets)");
  command->callback([arguments] { run(*arguments); });
}

/// Returns for each package whether it is in the folder of `vesalius assets`.
std::vector<std::pair<std::string, std::string>> packages() {
  std::vector<std::pair<std::string, std::string>> found;
  for (const AssetPackage& package : asset_packages()) {
    found.emplace_back(package.name, has_assets(package, default_assets_folder()) ? "present" : "absent");
  }
  return found;
}

}  // namespace

Satellite assets_satellite() { return {.name = "assets", .commands = {add_assets}, .facts = packages}; }

}  // namespace vesalius::cli
