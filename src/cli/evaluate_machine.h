#pragma once

#include <string>

namespace vesalius::cli {

/// What timings depend on, on one line: processor, threads in use, compiler and kind of build.
std::string machine_facts();

}  // namespace vesalius::cli
