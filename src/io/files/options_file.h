#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/options.h"

namespace vesalius {

/// Shows a visitor every option there is, e.g. [&](OptionVisitor& v) { visit_options("", options, v); }.
using VisitAll = std::function<void(OptionVisitor&)>;

/// Sets the options that a TOML text names ("search.min-parts = 6", or min-parts in a table [search]); others keep
/// their values. `name` stands for the path in errors. Throws Error with the line for bad TOML, an option that does
/// not exist (naming the nearest that does), a value of another type or out of its range.
void parse_options(std::string_view toml, const std::string& name, const VisitAll& visit);

/// The same from a file.
void read_options(const std::string& path, const VisitAll& visit);

/// Every option with its value as TOML that `parse_options` reads, under a comment with help, unit and range.
std::string options_toml(const VisitAll& visit);

/// Writes that text atomically; throws Error with the path.
void write_options(const VisitAll& visit, const std::string& path);

/// The entry of `known` that takes the fewest inserted, removed or changed letters to reach from `word`; empty where
/// none is within a third of its length.
std::string nearest_name(std::string_view word, const std::vector<std::string>& known);

}  // namespace vesalius
