#pragma once

#define TOML_EXCEPTIONS 1
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "vesalius/error.h"

// This header is for sources that read TOML. Headers must not include it, because it is slow to compile.
namespace vesalius {

/// Makes untrusted text fit for a one-line message: at most 64 characters, with control characters as "?".
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t kMost = 64;
  std::string out = "\"";
  for (const char c : text.substr(0, kMost)) out += (c >= ' ' && c != '\x7f') ? c : '?';
  return out + (text.size() > kMost ? "...\"" : "\"");
}

/// Reads typed values from TOML. Throws Error naming the source and the line if a value is missing, of another type or
/// out of range.
class TomlReader {
 public:
  /// `source` is used as the path in errors and must outlive this object.
  explicit TomlReader(const std::string& source) : source_(source) {}

  toml::table parse(std::string_view text) const {
    check_lines(text);
    try {
      return toml::parse(text);
    } catch (const toml::parse_error& e) {
      std::string what(e.description());
      std::ranges::replace_if(
          what, [](char c) { return (c >= '\0' && c < ' ') || c == '\x7f'; }, '?');
      throw Error(source_ + ":" + std::to_string(e.source().begin.line) + ": not valid TOML: " + what);
    }
  }

  /// Returns "FILE:LINE".
  std::string place(const toml::node& at) const { return source_ + ":" + std::to_string(at.source().begin.line); }

  [[noreturn]] void fail(const toml::node& at, const std::string& what) const { throw Error(place(at) + ": " + what); }

  /// `known` is a range of strings.
  template <class Keys = std::initializer_list<std::string_view>>
  void expect_keys(const toml::table& table, const Keys& known) const {
    for (const auto& [key, node] : table) {
      if (std::ranges::find(known, key.str()) != std::end(known)) continue;
      std::string list;
      for (const std::string_view k : known) list.append(list.empty() ? "" : ", ").append(k);
      fail(node, "unknown key " + in_quotes(key.str()) + ", expected " + list);
    }
  }

  const toml::node& need(const toml::table& table, std::string_view key) const {
    const toml::node* node = table.get(key);
    if (node == nullptr) fail(table, "missing key \"" + std::string(key) + "\"");
    return *node;
  }

  const toml::array& array(const toml::node& node, std::string_view what) const {
    if (!node.is_array()) fail(node, std::string(what) + ": expected an array");
    return *node.as_array();
  }
  const toml::array& array(const toml::table& table, std::string_view key) const {
    return array(need(table, key), key);
  }

  const toml::table& table(const toml::node& node, std::string_view what) const {
    if (!node.is_table()) fail(node, std::string(what) + ": expected a table");
    return *node.as_table();
  }

  std::string string(const toml::node& node, std::string_view what) const {
    const auto value = node.value_exact<std::string>();
    if (!value) fail(node, std::string(what) + ": expected a string");
    return *value;
  }

  float number(const toml::node& node, std::string_view what, double low, double high) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value) || *value < low || *value > high) {
      std::ostringstream message;
      message << what << ": expected a number from " << low << " to " << high;
      fail(node, message.str());
    }
    return float(*value);
  }
  float number(const toml::table& table, std::string_view key, double low, double high) const {
    return number(need(table, key), key, low, high);
  }
  /// Returns 0 where the table lacks the key.
  float number_or_zero(const toml::table& table, std::string_view key, double low, double high) const {
    return table.contains(key) ? number(table, key, low, high) : 0.F;
  }

  std::int64_t integer(const toml::node& node, std::string_view what, std::int64_t low, std::int64_t high) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < low || *value > high) {
      fail(node,
           std::string(what) + ": expected a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    }
    return *value;
  }

  bool boolean(const toml::table& table, std::string_view key) const {
    const toml::node& node = need(table, key);
    const auto value = node.value_exact<bool>();
    if (!value) fail(node, std::string(key) + ": expected true or false");
    return *value;
  }

 private:
  /// Throws for very long lines: a key with many thousand dotted levels overruns the parser's stack.
  void check_lines(std::string_view text) const {
    constexpr std::size_t kLongestLine = 4096;
    std::size_t begin = 0;
    for (int line = 1; begin < text.size(); ++line) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      if (end - begin > kLongestLine) {
        throw Error(source_ + ":" + std::to_string(line) + ": line of " + std::to_string(end - begin) +
                    " characters, expected at most " + std::to_string(kLongestLine));
      }
      begin = end + 1;
    }
  }

  const std::string& source_;
};

}  // namespace vesalius
