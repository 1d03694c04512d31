#include "cli/completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <vector>

namespace vesalius::cli {
namespace {

struct Flag {
  std::vector<std::string> names;  ///< with dashes; empty for a positional argument
  std::string choices;             ///< separated by spaces; empty if any word is allowed
};

/// Returns the words that an option allows. CLI11 keeps the words of IsMember only in its description, "TEXT:{a,b}".
std::string choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open == std::string::npos ? 0 : open);
  if (open == std::string::npos || close == std::string::npos) return "";
  std::string words = type.substr(open + 1, close - open - 1);
  std::ranges::replace(words, ',', ' ');
  return words;
}

std::vector<Flag> flags_of(const CLI::App& command) {
  std::vector<Flag> flags;
  for (const CLI::Option* option : command.get_options()) {
    Flag flag;
    for (const std::string& name : option->get_snames()) flag.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flag.names.push_back("--" + name);
    flag.choices = choices_of(*option);
    flags.push_back(std::move(flag));
  }
  return flags;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_name().empty(); });
}

std::string words_of(const CLI::App& command) {
  std::string words;
  for (const Flag& flag : flags_of(command)) {
    for (const std::string& name : flag.names) words += name + " ";
    if (flag.names.empty() && !flag.choices.empty()) words += flag.choices + " ";
  }
  return words;
}

std::string single_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string names;
  std::string cases;
  std::string values;
  for (const CLI::App* command : commands_of(app)) {
    names += command->get_name() + " ";
    cases += fmt::format("    {}) words={} ;;\n", command->get_name(), single_quoted(words_of(*command)));
    for (const Flag& flag : flags_of(*command)) {
      if (flag.names.empty() || flag.choices.empty()) continue;
      values += fmt::format("    {}:{}) COMPREPLY=($(compgen -W '{}' -- \"$cur\")); return ;;\n", command->get_name(),
                            flag.names.back(), flag.choices);
    }
  }
  return fmt::format(R"(_{0}() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} command=${{COMP_WORDS[1]}} words=''
  if [[ $COMP_CWORD -eq 1 ]]; then
    COMPREPLY=($(compgen -W '{1}' -- "$cur"))
    return
  fi
  case $command:${{COMP_WORDS[COMP_CWORD-1]}} in
{3}  esac
  case $command in
{2}  esac
  COMPREPLY=($(compgen -W "$words" -- "$cur"))
  [[ $cur == -* ]] || COMPREPLY+=($(compgen -f -- "$cur"))
}}
complete -o filenames -F _{0} {0}
)",
                     app.get_name(), names + words_of(app), cases, values);
}

}  // namespace vesalius::cli
