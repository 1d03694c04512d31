#include "io/files/options_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "io/files/atomic_file.h"
#include "io/files/read_file.h"
#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

// A key with n dots nests n tables, and the TOML library frees them by recursion. A text of this size cannot exhaust
// the stack.
constexpr std::size_t kMaxOptionsBytes = std::size_t{1} << 14;
constexpr std::size_t kMaxShown = 64;

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
      const std::string nearest = nearest_name(option, known);
      fail(*node, fmt::format("no option is called {}{}", in_quotes(option),
                              nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest)));
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

class NameCollector : public OptionVisitor {
 public:
  void option(const std::string& name, float& /*value*/, const OptionInfo& /*info*/) override { names.push_back(name); }
  void option(const std::string& name, int& /*value*/, const OptionInfo& /*info*/) override { names.push_back(name); }
  void option(const std::string& name, bool& /*value*/, const OptionInfo& /*info*/) override { names.push_back(name); }
  void option(const std::string& name, std::string& /*value*/, const OptionInfo& /*info*/) override {
    names.push_back(name);
  }

  std::vector<std::string> names;
};

class Setter : public OptionVisitor {
 public:
  explicit Setter(const Values& values) : values_(values) {}

  void option(const std::string& name, float& value, const OptionInfo& info) override {
    const toml::node* node = values_.find(name);
    if (node == nullptr) return;
    const auto read = node->is_number() ? node->value<double>() : std::nullopt;
    if (!read) values_.fail(*node, name + ": expected a number");
    set(*node, name, value, static_cast<float>(*read), info);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    const toml::node* node = values_.find(name);
    if (node == nullptr) return;
    const auto read = node->value_exact<std::int64_t>();
    if (!read || *read != static_cast<int>(*read)) values_.fail(*node, name + ": expected a whole number");
    set(*node, name, value, static_cast<int>(*read), info);
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

class TomlWriter : public OptionVisitor {
 public:
  void option(const std::string& name, float& value, const OptionInfo& info) override {
    std::string number = fmt::format("{}", value);
    if (number.find_first_not_of("-0123456789") == std::string::npos) number += ".0";  // a real stays a real in TOML
    line(name, number, info, true);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    line(name, std::to_string(value), info, true);
  }
  void option(const std::string& name, bool& value, const OptionInfo& info) override {
    line(name, value ? "true" : "false", info, false);
  }
  void option(const std::string& name, std::string& value, const OptionInfo& info) override {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    line(name, quoted.str(), info, false);
  }

  std::string text;

 private:
  void line(const std::string& name, const std::string& value, const OptionInfo& info, bool ranged) {
    const std::string stage = name.substr(0, name.rfind('.'));
    if (!text.empty() && stage != stage_) text += '\n';
    stage_ = stage;
    text += fmt::format("# {}", info.help);
    if (ranged) {
      const std::string unit = *info.unit == '\0' ? "" : fmt::format(" {}", info.unit);
      text += fmt::format(" ({} to {}{})", info.low, info.high, unit);
    }
    text += fmt::format("\n{} = {}\n", name, value);
  }

  std::string stage_;
};

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
  NameCollector known;
  visit(known);
  values.expect_only(known.names);
  Setter setter(values);
  visit(setter);
}

void read_options(const std::string& path, const VisitAll& visit) {
  parse_options(read_file(path, kMaxOptionsBytes), path, visit);
}

std::string options_toml(const VisitAll& visit) {
  TomlWriter writer;
  visit(writer);
  return writer.text;
}

void write_options(const VisitAll& visit, const std::string& path) { write_file_atomically(path, options_toml(visit)); }

}  // namespace vesalius
