#pragma once

#include <string>
#include <vector>

namespace vesalius::standin {

/// A library that a program of an interface has, whose handles it passes on.
struct ProgramLibrary {
  std::string name;                ///< as its file begins, e.g. "libk4a"
  std::string but;                 ///< names that begin so are another library's; empty = none
  const char* variable;            ///< of the environment: a path to take in place of all
  const char* function;            ///< one that it has
  std::vector<std::string> files;  ///< what to load where the program has none
};

/// Returns what dlopen returns for it, or RTLD_DEFAULT: for the library that the variable names; else for whichever the
/// program has loaded, visible to all or not; else for one of the system. It stays for good. Throws Error if there is
/// none.
void* find_program_library(const ProgramLibrary& library);

}  // namespace vesalius::standin
