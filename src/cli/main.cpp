#include <fcntl.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "console/satellites.h"
#include "console/text_sink.h"
#include "io/files/options_file.h"
#include "vesalius/error.h"

namespace vesalius::cli {

// CMake writes satellites.inc, which names the satellites of this build.
#define VESALIUS_SATELLITE(name) Satellite name##_satellite();
#include "satellites.inc"
#undef VESALIUS_SATELLITE

namespace {

std::vector<Satellite> satellites_of_this_build() {
  return {
#define VESALIUS_SATELLITE(name) name##_satellite(),
#include "satellites.inc"
#undef VESALIUS_SATELLITE
  };
}

/// Refuses empty values of flags: they come from unset shell variables rather than from an intention.
void refuse_empty_values(CLI::App& program) {
  const auto check = [](const std::string& value) { return value.empty() ? "expected a value, found none" : ""; };
  for (CLI::App* command : program.get_subcommands({})) {
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_max() > 0) option->check(check);
    }
  }
}

/// Makes `program` the program vesalius with the commands of this build. It must live as long as these.
void describe_program(CLI::App& program) {
  use_satellites(satellites_of_this_build());
  program.name("vesalius");
  program.description(
      "Finds people in RGB-D frames: 3-D body parts and joints, a part label for every pixel, a mask per person.");
  program.set_version_flag("--version", "vesalius " VESALIUS_VERSION, "Print the version and end");
  program.get_option("--help")->description("Print this help and end");
  program.footer(R"(
Examples:
  vesalius detect frames/                                  what is found, a line per frame
  vesalius detect frames/ --json people.jsonl --out pictures/
  vesalius info data/models/default.model                  what is in a model
  vesalius train --data train/ --out my.forest             a model of your own
  vesalius detect --help                                   everything about one command

Exit codes: 0 done, 1 failed, 2 wrong usage.)");
  program.require_subcommand(1);
  add_detect(program);
  add_info(program);
  add_convert(program);
  add_export(program);
  add_record(program);
  add_cameras(program);
  add_bench(program);
  for (const Satellite& satellite : satellites()) {
    for (const auto add : satellite.commands) add(program);
  }
  add_options(program);
  refuse_empty_values(program);
}

constexpr int kFailed = 1;
constexpr int kUsage = 2;

int complain(const std::string& message, int exit_code) {
  // What a source holds is listed on indented lines below an error.
  constexpr std::string_view kLine = "\n  ";
  std::size_t at = message.find(kLine);
  say("vesalius: " + message.substr(0, at));
  while (at != message.npos) {
    const std::size_t next = message.find(kLine, at + 1);
    say(message.substr(at + 1, next == message.npos ? next : next - at - 1));
    at = next;
  }
  return exit_code;
}

std::vector<std::string> names_in(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Returns what is wrong where CLI11 could not read an option's value; it leaves out the names of hidden ones. Empty
/// for other errors.
std::string unread_value(const CLI::App& command, const std::string& message) {
  const std::size_t equals = message.rfind(" = ");
  if (!message.starts_with("Could not convert") || equals == message.npos) return {};
  const std::string value = message.substr(equals + 3);
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_lnames().empty() || option->count() == 0 || option->results().back() != value) continue;
    return fmt::format("--{}: {} is not a value of it, expected {}", option->get_lnames().front(), value,
                       option->get_type_name() == "INT" ? "a whole number" : "a number");
  }
  return {};
}

/// Returns the message for a command line that CLI11 refused. CLI11 may report what is missing instead of the misspelt
/// word.
std::string explain(const CLI::App& program, const CLI::ParseError& error) {
  const auto chosen = program.get_subcommands();
  const CLI::App& command = chosen.empty() ? program : *chosen.front();
  const std::string help = fmt::format(" (see vesalius {}--help)", chosen.empty() ? "" : command.get_name() + " ");
  const std::vector<std::string> unknown = command.remaining();
  if (unknown.empty()) {
    const std::string unread = unread_value(command, error.what());
    return (unread.empty() ? error.what() : unread) + help;
  }
  if (std::string absent = absent_command(unknown.front()); chosen.empty() && !absent.empty()) return absent;
  const std::string nearest = nearest_name(unknown.front(), names_in(command));
  return fmt::format("unknown argument {}{}{}", unknown.front(),
                     nearest.empty() ? "" : fmt::format(", did you mean {}?", nearest), help);
}

int run(int argc, char** argv) {
  CLI::App program;
  describe_program(program);
  try {
    if (argc < 2) {
      std::fputs(program.help().c_str(), stderr);
      return kUsage;
    }
    program.parse(argc, argv);
    finish_stdout();
    return 0;
  } catch (const CLI::Success& e) {  // --help and --version
    program.exit(e);
    finish_stdout();
    return 0;
  } catch (const CLI::ParseError& e) {
    return complain(explain(program, e), kUsage);
  }
}

/// Opens /dev/null for standard streams that are closed. Otherwise the next file would get the number of the closed
/// stream, and receive its text.
void occupy_standard_streams() {
  for (const auto& [fd, mode] : {std::pair(0, O_WRONLY), std::pair(1, O_RDONLY), std::pair(2, O_RDONLY)}) {
    // open() takes the lowest free number. The mode makes every use fail, as it does with a closed stream.
    if (::fcntl(fd, F_GETFD) < 0) ::open("/dev/null", mode);
  }
}

int guarded(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const BrokenPipe&) {
    return kFailed;  // the reader has closed the pipe, so nobody would see a message
  } catch (const UsageError& e) {
    return complain(e.what(), kUsage);
  } catch (const Error& e) {
    return complain(e.what(), kFailed);
  } catch (const std::bad_alloc&) {
    return complain("out of memory", kFailed);
  } catch (const std::exception& e) {
    return complain(std::string("internal error: ") + e.what(), kFailed);
  }
}

}  // namespace
}  // namespace vesalius::cli

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe throws instead, which removes temporary files
  std::signal(SIGXFSZ, SIG_IGN);  // the same for a file that exceeds the shell's limit
  vesalius::cli::occupy_standard_streams();
  return vesalius::cli::guarded(argc, argv);
}
