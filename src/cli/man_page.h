#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace vesalius::cli {

/// A page of the manual, for section 1.
struct ManPage {
  std::string name;  ///< e.g. "vesalius-detect"
  std::string text;  ///< roff with the macros of man(7)
};

/// Returns the manual of a program: a page for itself and one for each command, commands of commands too. They hold
/// what --help prints, and the flags that it leaves out because there are many, with their defaults. Pages carry no
/// date: the same program gives the same bytes.
std::vector<ManPage> man_pages(const CLI::App& program);

}  // namespace vesalius::cli
