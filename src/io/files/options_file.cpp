#include "io/files/options_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "io/files/atomic_file.h"
#include "io/files/data_file.h"
#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

// A key with n dots nests n tables, and the TOML library frees them by recursion. A text of this size cannot exhaust
// the stack.
constexpr std::size_t kMaxOptionsBytes = std::size_t{1} << 14;
constexpr std::size_t kMaxShown = 64;

std::string unknown_option(const std::string& name, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(name, known);
  return fmt::format("no option is called {}{}", in_quotes(name),
                     nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest));
}

/// The values of a TOML text by their dotted names.
class Values : public TomlReader {
 public:
  Values(const toml::table& root, const std::string& name) : TomlReader(name) { collect("", root); }

  const toml::node* find(const std::string& option) const {
    const auto found = nodes_.find(option);
    return found == nodes_.end() ? nullptr : found->second;
  }
  void expect_only(const std::vector<std::string>& known) const {
    for (const auto& [option, node] : nodes_) {
      if (std::ranges::find(known, option) != known.end()) continue;
      fail(*node, unknown_option(option, known));
    }
  }

 private:
  void collect(const std::string& prefix, const toml::table& table) {
    for (const auto& [key, node] : table) {
      const std::string option = prefix + std::string(key.str());
      if (const toml::table* inner = node.as_table()) {
        collect(option + ".", *inner);
      } else {
        nodes_[option] = &node;
      }
    }
  }

  std::map<std::string, const toml::node*> nodes_;
};

class Lister : public OptionVisitor {
 public:
  void option(const std::string& name, float& value, const OptionInfo& info) override {
    std::string number = fmt::format("{}", value);
    if (number.find_first_not_of("-0123456789") == std::string::npos) number += ".0";  // a real stays a real in TOML
    options.push_back({name, OptionKind::number, number, info});
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    options.push_back({name, OptionKind::whole_number, std::to_string(value), info});
  }
  void option(const std::string& name, bool& value, const OptionInfo& info) override {
    options.push_back({name, OptionKind::truth, value ? "true" : "false", info});
  }
  void option(const std::string& name, std::string& value, const OptionInfo& info) override {
    options.push_back({name, OptionKind::word, value, info});
  }

  std::vector<OptionText> options;
};

std::vector<std::string> names_of(const VisitAll& visit) {
  std::vector<std::string> names;
  for (OptionText& option : list_options(visit)) names.push_back(std::move(option.name));
  return names;
}

/// Returns the number that the whole text states, if it states one.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Sets the option of one name to what a text states.
class TextSetter : public OptionVisitor {
 public:
  TextSetter(const std::string& name, std::string_view text) : name_(name), text_(text) {}

  void option(const std::string& name, float& value, const OptionInfo& info) override {
    if (!wanted(name)) return;
    const auto read = number_in<double>(text_);
    if (!read) fail("a number");
    set(value, float(*read), info);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    if (!wanted(name)) return;
    const auto read = number_in<int>(text_);
    if (!read) fail("a whole number");
    set(value, *read, info);
  }
  void option(const std::string& name, bool& value, const OptionInfo& /*info*/) override {
    if (!wanted(name)) return;
    if (text_ != "true" && text_ != "false") fail("true or false");
    value = text_ == "true";
  }
  void option(const std::string& name, std::string& value, const OptionInfo& /*info*/) override {
    if (wanted(name)) value = text_;
  }

  bool found() const { return found_; }

 private:
  bool wanted(const std::string& name) {
    if (name != name_) return false;
    found_ = true;
    return true;
  }
  template <class T>
  void set(T& value, T read, const OptionInfo& info) const {
    RangeCheck().option(name_, read, info);
    value = read;
  }
  [[noreturn]] void fail(const char* expected) const {
    throw UsageError(fmt::format("option {}: found {}, expected {}", name_, in_quotes(text_), expected));
  }

  const std::string& name_;
  std::string_view text_;
  bool found_ = false;
};

class Setter : public OptionVisitor {
 public:
  explicit Setter(const Values& values) : values_(values) {}

  void option(const std::string& name, float& value, const OptionInfo& info) override {
    const toml::node* node = values_.find(name);
    if (node == nullptr) return;
    const auto read = node->is_number() ? node->value<double>() : std::nullopt;
    if (!read) values_.fail(*node, name + ": expected a number");
    set(*node, name, value, float(*read), info);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    const toml::node* node = values_.find(name);
    if (node == nullptr) return;
    const auto read = node->value_exact<std::int64_t>();
    if (!read || *read != int(*read)) values_.fail(*node, name + ": expected a whole number");
    set(*node, name, value, int(*read), info);
  }
  void option(const std::string& name, bool& value, const OptionInfo& /*info*/) override {
    const toml::node* node = values_.find(name);
    if (node == nullptr) return;
    const auto read = node->value_exact<bool>();
    if (!read) values_.fail(*node, name + ": expected true or false");
    value = *read;
  }
  void option(const std::string& name, std::string& value, const OptionInfo& /*info*/) override {
    const toml::node* node = values_.find(name);
    if (node == nullptr) return;
    const auto read = node->value_exact<std::string>();
    if (!read) values_.fail(*node, name + ": expected a text in quotes");
    value = *read;
  }

 private:
  template <class T>
  void set(const toml::node& node, const std::string& name, T& value, T read, const OptionInfo& info) const {
    try {
      RangeCheck().option(name, read, info);
    } catch (const UsageError& e) {
      values_.fail(node, e.what());  // Error with the line, since the file is at fault and not the command line
    }
    value = read;
  }

  const Values& values_;
};

std::string quoted(const std::string& word) {
  std::ostringstream text;
  text << toml::value<std::string>(word);
  return text.str();
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view word, const std::vector<std::string>& known) {
  std::string nearest;
  if (word.size() > kMaxShown) return nearest;
  std::size_t fewest = kMaxShown;
  for (const std::string& name : known) {
    // Leaving out the stage is a common slip: "min-parts" instead of "search.min-parts".
    const std::string_view last = std::string_view(name).substr(name.rfind('.') + 1);
    const std::size_t distance = std::min(edit_distance(word, name), edit_distance(word, last) + 1);
    if (distance < fewest && distance <= word.size() / 3 + 1) {
      fewest = distance;
      nearest = name;
    }
  }
  return nearest;
}

void parse_options(std::string_view toml, const std::string& name, const VisitAll& visit) {
  const toml::table root = TomlReader(name).parse(toml);
  const Values values(root, name);
  values.expect_only(names_of(visit));
  Setter setter(values);
  visit(setter);
}

void read_options(const std::string& path, const VisitAll& visit) {
  parse_options(read_file(path, kMaxOptionsBytes), path, visit);
}

std::vector<OptionText> list_options(const VisitAll& visit) {
  Lister lister;
  visit(lister);
  return std::move(lister.options);
}

void set_option(const std::string& name, std::string_view text, const VisitAll& visit) {
  TextSetter setter(name, text);
  visit(setter);
  if (!setter.found()) throw UsageError(unknown_option(name, names_of(visit)));
}

std::string options_toml(const VisitAll& visit) {
  std::string text, last_stage;
  for (const auto& [name, kind, value, info] : list_options(visit)) {
    const std::string stage = name.substr(0, name.rfind('.'));
    if (!text.empty() && stage != last_stage) text += '\n';
    last_stage = stage;
    text += fmt::format("# {}", info.help);
    if (kind == OptionKind::number || kind == OptionKind::whole_number) {
      const std::string unit = *info.unit == '\0' ? "" : fmt::format(" {}", info.unit);
      text += fmt::format(" ({} to {}{})", info.low, info.high, unit);
    }
    text += fmt::format("\n{} = {}\n", name, kind == OptionKind::word ? quoted(value) : value);
  }
  return text;
}

void write_options(const VisitAll& visit, const std::string& path) { write_file_atomically(path, options_toml(visit)); }

}  // namespace vesalius
