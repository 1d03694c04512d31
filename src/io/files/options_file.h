#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/options.h"

namespace vesalius {

/// A function that shows every option to a visitor, e.g. [&](OptionVisitor& v) { visit_options("", options, v); }.
using VisitAll = std::function<void(OptionVisitor&)>;

/// Sets the options that a TOML text names ("search.min-parts = 6", or min-parts in a table [search]); all others keep
/// their values. `name` is used as the path in errors. Throws Error with the line for invalid TOML, for an unknown
/// option (naming the most similar known one), and for a value of the wrong type or out of range.
void parse_options(std::string_view toml, const std::string& name, const VisitAll& visit);

/// What values an option takes.
enum class OptionKind { number, whole_number, truth, word };

/// An option with its value as text, as `set_option` reads it.
struct OptionText {
  std::string name;
  OptionKind kind = OptionKind::number;
  std::string value;
  OptionInfo info;  ///< its range applies to numbers
};

/// Returns every option with its value.
std::vector<OptionText> list_options(const VisitAll& visit);

/// Sets one option to the value that a text states: a number, a whole number, "true" or "false", or a word as it
/// stands. All others keep their values. Throws UsageError for an unknown option (naming the most similar known one),
/// and for a value of the wrong type or out of range; the option keeps its value then.
void set_option(const std::string& name, std::string_view text, const VisitAll& visit);

/// Reads the options from a file; see `parse_options`.
void read_options(const std::string& path, const VisitAll& visit);

/// Returns every option with its value as TOML that `parse_options` reads. A comment above each option gives its help
/// text, unit and range.
std::string options_toml(const VisitAll& visit);

/// Writes the text of `options_toml` atomically. Throws Error with the path.
void write_options(const VisitAll& visit, const std::string& path);

/// Returns the entry of `known` with the smallest edit distance to `word` (letters inserted, removed or changed).
/// Returns an empty string if every distance exceeds a third of the word's length.
std::string nearest_name(std::string_view word, const std::vector<std::string>& known);

}  // namespace vesalius
