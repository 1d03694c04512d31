#pragma once

#include <exception>
#include <iostream>

namespace vesalius {

/// Returns the exit code of `work`, or 1 after saying on standard error, with the tool's name, what it throws.
template <class Work>
int run_tool(const char* name, const Work& work) {
  try {
    return work();
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << '\n';
    return 1;
  }
}

}  // namespace vesalius
