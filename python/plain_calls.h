#pragma once

#include <nanobind/nanobind.h>

namespace vesalius {

/// Defines what vesalius/_calls.py says of wrong calls with.
void bind_plain_calls(nanobind::module_& m);

}  // namespace vesalius
