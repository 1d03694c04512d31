#pragma once

#include <string>
#include <vector>

#include "io/files/options_file.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// Largest value of every command's --threads.
inline constexpr int kMaxThreads = 1024;

/// A flag for every option that `visit` shows, e.g. --search.min-parts. `visit` and the options must live as long as
/// the command. --help leaves these flags out because there are many (`vesalius options` lists them).
class FlagSet {
 public:
  FlagSet(CLI::App& command, const VisitAll& visit);
  ~FlagSet();
  FlagSet(const FlagSet&) = delete;
  FlagSet& operator=(const FlagSet&) = delete;

  /// Overwrites the options that were given on the command line. `visit` must show options of the same kind.
  void apply(const VisitAll& visit) const;

 private:
  struct Flag;
  std::vector<Flag> flags_;
};

/// A FlagSet for a struct that has visit_options.
template <class Options>
class OptionFlags {
 public:
  explicit OptionFlags(CLI::App& command)
      : flags_(command, [this](OptionVisitor& visitor) { visit_options("", values_, visitor); }) {}

  void apply(Options& options) const {
    flags_.apply([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }

 private:
  Options values_;  ///< the flags write into these
  FlagSet flags_;
};

}  // namespace vesalius::cli
