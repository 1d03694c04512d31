#include "cli/completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string_view>
#include <vector>

namespace vesalius::cli {
namespace {

struct Flag {
  std::vector<std::string> names;  ///< with dashes; empty: positional
  std::string help;
  std::string choices;  ///< separated by spaces; empty: anything
  bool takes_value = false;
};

/// CLI11 keeps the words that IsMember allows only in its description, "TEXT:{a,b}".
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
    flag.help = option->get_description();
    flag.choices = choices_of(*option);
    flag.takes_value = option->get_items_expected_max() > 0;
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

/// `text` with `escape` before each of `special`.
std::string escaped(std::string_view text, std::string_view special, std::string_view escape) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += escape;
    out += c;
  }
  return out;
}

std::string single_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string fish_quoted(std::string_view text) { return "'" + escaped(text, "'\\", "\\") + "'"; }

std::string zsh_line(const Flag& flag) {
  if (flag.names.empty()) {
    return flag.choices.empty() ? "'*:file:_files'" : fmt::format("'1:choice:({})'", flag.choices);
  }
  std::string value;
  if (flag.takes_value) value = flag.choices.empty() ? ":value:_files" : fmt::format(":value:({})", flag.choices);
  std::string line;
  for (const std::string& name : flag.names) {
    const std::string help = escaped(flag.help, "[]:\\", "\\");
    line.append(line.empty() ? "" : " ").append(single_quoted(fmt::format("{}[{}]{}", name, help, value)));
  }
  return line;
}

std::string fish_line(const std::string& program, const std::string& condition, const Flag& flag) {
  std::string line = fmt::format("complete -c {} -n {}", program, fish_quoted(condition));
  for (const std::string& name : flag.names) {
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  if (flag.takes_value && !flag.names.empty()) line += flag.choices.empty() ? " -r -F" : " -x";
  if (!flag.choices.empty()) line += " -a " + fish_quoted(flag.choices);
  return line + " -d " + fish_quoted(flag.help) + "\n";
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

std::string zsh_completion(const CLI::App& app) {
  std::string commands;
  std::string cases;
  for (const CLI::App* command : commands_of(app)) {
    commands +=
        "    " + single_quoted(command->get_name() + ":" + escaped(command->get_description(), ":\\", "\\")) + "\n";
    cases += fmt::format("    {})\n      _arguments", command->get_name());
    for (const Flag& flag : flags_of(*command)) cases += " \\\n        " + zsh_line(flag);
    cases += " ;;\n";
  }
  return fmt::format(R"(#compdef {0}
_{0}() {{
  local -a commands
  commands=(
{1}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  shift words
  (( CURRENT-- ))
  case $words[1] in
{2}  esac
}}
compdef _{0} {0}
)",
                     app.get_name(), commands, cases);
}

std::string fish_completion(const CLI::App& app) {
  std::string script;
  for (const Flag& flag : flags_of(app)) script += fish_line(app.get_name(), "__fish_use_subcommand", flag);
  for (const CLI::App* command : commands_of(app)) {
    script += fmt::format("complete -c {} -n __fish_use_subcommand -f -a {} -d {}\n", app.get_name(),
                          command->get_name(), fish_quoted(command->get_description()));
    for (const Flag& flag : flags_of(*command)) {
      if (flag.names.empty() && flag.choices.empty()) continue;  // fish offers files by itself
      script += fish_line(app.get_name(), "__fish_seen_subcommand_from " + command->get_name(), flag);
    }
  }
  return script;
}

}  // namespace vesalius::cli
