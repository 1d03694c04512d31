#pragma once

#include <nanobind/nanobind.h>

#include <string>

#include "vesalius/track_people.h"

namespace vesalius {

/// Sets options by keywords: the option search.min-parts is search_min_parts. Throws UsageError for a keyword that is
/// no option, a value of another type, or one out of range.
void set_options(PeopleOptions& options, const nanobind::dict& keywords);

/// Returns the values of all options by their keywords.
nanobind::dict options_as_dict(PeopleOptions options);

/// Returns a line for each option: its keyword, default, unit and what it is.
std::string describe_options();

}  // namespace vesalius
