#include "cli/man_page.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <functional>
#include <regex>
#include <set>
#include <sstream>
#include <string_view>

namespace vesalius::cli {
namespace {

constexpr std::string_view kExitCodes = "Exit codes:";

/// Escapes what roff reads as commands or replaces by other characters, so that flags can be copied from the page.
std::string escaped_roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\\':
        out += "\\(rs";
        break;
      case '-':
        out += "\\-";
        break;
      case '\'':
        out += "\\(aq";
        break;
      case '`':
        out += "\\(ga";
        break;
      case '^':
        out += "\\(ha";
        break;
      case '~':
        out += "\\(ti";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// A dot that begins a line would be a request.
std::string line(const std::string& roff) { return (roff.starts_with('.') ? "\\&" : "") + roff + "\n"; }

std::string bold(std::string_view text) { return "\\fB" + escaped_roff(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + escaped_roff(text) + "\\fR"; }
std::string reference(std::string_view page) { return bold(page) + "(1)"; }

/// Words between backticks become bold.
std::string prose(std::string_view text) {
  std::string out;
  for (bool inside = false;; inside = !inside) {
    const std::size_t tick = text.find('`');
    const std::string_view piece = text.substr(0, tick);
    out += inside ? bold(piece) : escaped_roff(piece);
    if (tick == std::string_view::npos) return out;
    text.remove_prefix(tick + 1);
  }
}

std::string sentence(const std::string& text) {
  const bool ends = text.empty() || std::string_view(".)?!").find(text.back()) != std::string_view::npos;
  return prose(text) + (ends ? "" : ".");
}

std::string page_name(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name()
                                         : page_name(*command.get_parent()) + "-" + command.get_name();
}

std::string command_line(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name()
                                         : command_line(*command.get_parent()) + " " + command.get_name();
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

/// Returns the names of options, in alphabetical order: CLI11 keeps them by address.
std::string names_of(const std::set<CLI::Option*>& options) {
  std::vector<std::string> names;
  for (const CLI::Option* option : options) names.push_back(bold(option->get_name()));
  std::ranges::sort(names);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What a flag takes: CLI11 keeps placeholder and checks in one text, "N:INT in [0 - 1024]".
struct Value {
  std::string placeholder;
  std::string limits;  ///< as a sentence in roff; empty without
};

Value value_of(const CLI::Option& option) {
  static const std::regex range(R"((.*):[A-Z]+ in \[(\S+) - (\S+)\])"), words(R"((.*):\{(.*)\})"),
      not_negative("(.*):NONNEGATIVE");
  const std::string type = option.get_type_name();
  std::smatch found;
  if (std::regex_match(type, found, range)) {
    return {found[1], escaped_roff(fmt::format(" From {} to {}.", found[2].str(), found[3].str()))};
  }
  if (std::regex_match(type, found, words)) {
    return {found[1], " Of: " + escaped_roff(std::regex_replace(found[2].str(), std::regex(","), ", ")) + "."};
  }
  if (std::regex_match(type, found, not_negative)) return {found[1], " Not negative."};
  return {type, ""};
}

/// Returns an option's names, what it takes and all that is said of it, as an item of a list.
std::string item(const CLI::Option& option) {
  const Value value = value_of(option);
  const bool takes_value = option.get_items_expected_max() > 0;
  const bool takes_many = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back(bold("-" + name));
  for (const std::string& name : option.get_lnames()) names.push_back(bold("--" + name));
  std::string head = fmt::format("{}", fmt::join(names, ", "));
  if (option.get_positional()) {
    head = italic(option.get_name(true));
  } else if (takes_value) {
    head += " " + italic(value.placeholder);
  }
  std::string text = sentence(option.get_description()) + (takes_value ? value.limits : "");
  const std::string initial = option.get_default_str();
  if (!initial.empty()) text += escaped_roff(fmt::format(" Default: {}.", initial));
  if (option.get_required()) text += " Required.";
  if (!option.get_needs().empty()) text += " Needs " + names_of(option.get_needs()) + ".";
  if (!option.get_excludes().empty()) text += " Not with " + names_of(option.get_excludes()) + ".";
  return ".TP\n" + line(head + (takes_many ? " ..." : "")) + line(text);
}

/// Blocks of a footer: lines up to an empty one.
std::vector<std::vector<std::string>> blocks_of(const std::string& text) {
  std::vector<std::vector<std::string>> blocks(1);
  std::istringstream lines(text);
  for (std::string each; std::getline(lines, each);) {
    if (!each.empty()) {
      blocks.back().push_back(each);
    } else if (!blocks.back().empty()) {
      blocks.emplace_back();
    }
  }
  if (blocks.back().empty()) blocks.pop_back();
  return blocks;
}

bool shows_examples(const std::vector<std::string>& block) { return block.front().starts_with("Example"); }
bool tells_exit_codes(const std::vector<std::string>& block) { return block.front().starts_with(kExitCodes); }

/// A command without a footer has got from CLI11 the one that its parent had at that time.
std::vector<std::vector<std::string>> own_blocks(const CLI::App& command) {
  for (const CLI::App* above = command.get_parent(); above != nullptr; above = above->get_parent()) {
    if (above->get_footer() == command.get_footer()) return {};
  }
  return blocks_of(command.get_footer());
}

std::string head_of(const CLI::App& command) {
  const std::string name = page_name(command);
  std::string title = name, what = command.get_description();
  std::ranges::transform(title, title.begin(), [](unsigned char c) { return std::toupper(c); });
  if (!what.empty()) what[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(what[0])));
  if (what.ends_with('.')) what.pop_back();
  // Names and flags are not to be hyphenated, nor spread.
  return fmt::format(".TH {} 1 \"\" \"vesalius {}\" \"User Commands\"\n.nh\n.ad l\n.SH NAME\n{} \\- {}\n",
                     escaped_roff(title), VESALIUS_VERSION, escaped_roff(name), prose(what));
}

std::string synopsis_of(const CLI::App& command) {
  std::string text = bold(command_line(command)) + " [" + italic("OPTION") + "]...";
  for (const CLI::Option* option : command.get_options([](const CLI::Option* o) { return o->get_positional(); })) {
    const std::string name = italic(option->get_name(true));
    text += option->get_required() ? " " + name : " [" + name + "]";
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += "...";
  }
  if (!commands_of(command).empty()) {
    text += command.get_require_subcommand_min() > 0 ? " " + italic("COMMAND") : " [" + italic("COMMAND") + "]";
  }
  return ".SH SYNOPSIS\n" + line(text);
}

std::string description_of(const CLI::App& command) {
  std::string text = ".SH DESCRIPTION\n" + line(sentence(command.get_description()));
  for (const std::vector<std::string>& block : own_blocks(command)) {
    if (shows_examples(block) || tells_exit_codes(block)) continue;
    text += ".PP\n";
    for (const std::string& each : block) text += line(prose(each));
  }
  return text;
}

std::string items(const CLI::App& command, const std::function<bool(const CLI::Option*)>& chosen) {
  std::string text;
  for (const CLI::Option* option : command.get_options(chosen)) text += item(*option);
  return text;
}

std::string options_of(const CLI::App& command) {
  std::string text;
  const std::string arguments = items(command, [](const CLI::Option* o) { return o->get_positional(); });
  if (!arguments.empty()) text += ".SH ARGUMENTS\n" + arguments;
  text += ".SH OPTIONS\n";
  std::string hidden;
  for (const std::string& group : command.get_groups()) {
    const std::string found =
        items(command, [&](const CLI::Option* o) { return !o->get_positional() && o->get_group() == group; });
    if (group.empty()) {
      hidden = found;
    } else if (!found.empty()) {
      text += (group == "Options" ? "" : ".SS " + escaped_roff(group) + "\n") + found;
    }
  }
  if (hidden.empty()) return text;
  return text + ".SS Options that a file can hold\nA file of options or a recipe holds these under the same names; " +
         line(reference("vesalius-options") + " prints it.") + hidden;
}

std::string commands_text(const CLI::App& command) {
  std::string text;
  for (const CLI::App* inner : commands_of(command)) {
    text += ".TP\n" + line(reference(page_name(*inner))) + line(sentence(inner->get_description()));
  }
  return text.empty() ? "" : ".SH COMMANDS\n" + text;
}

std::string examples_of(const CLI::App& command) {
  std::string text;
  for (const std::vector<std::string>& block : own_blocks(command)) {
    if (!shows_examples(block)) continue;
    text += ".SH EXAMPLES\n.nf\n";
    for (std::size_t i = 1; i < block.size(); ++i) {
      text += line(escaped_roff(std::string_view(block[i]).substr(std::min<std::size_t>(2, block[i].size()))));
    }
    text += ".fi\n";
  }
  return text;
}

std::string exit_status(const CLI::App& program) {
  for (const std::vector<std::string>& block : blocks_of(program.get_footer())) {
    if (!tells_exit_codes(block)) continue;
    std::string text = block.front().substr(kExitCodes.size() + 1);
    for (std::size_t i = 1; i < block.size(); ++i) text += " " + block[i];
    return ".SH EXIT STATUS\n" + line(sentence(text));
  }
  return "";
}

std::string places() {
  return ".SH ENVIRONMENT\n.TP\n" + bold("VESALIUS_MODELS") + "\nFolder in which models are looked for first.\n.TP\n" +
         bold("VESALIUS_ASSETS") + "\nFolder of the packages that " + line(reference("vesalius-assets") + " fetches.") +
         ".SH FILES\nBelow the folder in whose " + italic("bin") + " the program stands:\n.TP\n" +
         italic("share/vesalius/models/default.forest") + "\nThe model that is used where none is given.\n.TP\n" +
         italic("share/vesalius/bodies/") + "\nBody models.\n.TP\n" + italic("share/vesalius/demo/") +
         "\nSix frames to try it with.\n";
}

std::string see_also(const CLI::App& command) {
  std::vector<std::string> pages;
  if (command.get_parent() != nullptr) pages.push_back(reference(page_name(*command.get_parent())));
  for (const CLI::App* inner : commands_of(command)) pages.push_back(reference(page_name(*inner)));
  return pages.empty() ? "" : ".SH SEE ALSO\n" + line(fmt::format("{}", fmt::join(pages, ",\n")));
}

void add_pages(const CLI::App& program, const CLI::App& command, std::vector<ManPage>& pages) {
  pages.push_back({page_name(command), head_of(command) + synopsis_of(command) + description_of(command) +
                                           options_of(command) + commands_text(command) + examples_of(command) +
                                           (&command == &program ? places() : "") + exit_status(program) +
                                           see_also(command)});
  for (const CLI::App* inner : commands_of(command)) add_pages(program, *inner, pages);
}

}  // namespace

std::vector<ManPage> man_pages(const CLI::App& program) {
  std::vector<ManPage> pages;
  add_pages(program, program, pages);
  return pages;
}

}  // namespace vesalius::cli
