#pragma once

#include <string>

namespace vesalius::cli {

/// Returns one line with the facts that timings depend on: processor, number of threads, compiler and kind of build.
std::string machine_facts();

}  // namespace vesalius::cli
