#pragma once

#include <string>
#include <vector>

#include "io/files/options_file.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// --threads of every command: how many there may be.
inline constexpr int kMaxThreads = 1024;

/// A flag for every option that `visit` shows, e.g. --search.min-parts; `visit` and what it shows must live as long as
/// the command. They are left out of --help (there are many; `vesalius options` lists them) and known to completion.
class FlagSet {
 public:
  FlagSet(CLI::App& command, const VisitAll& visit);
  ~FlagSet();
  FlagSet(const FlagSet&) = delete;
  FlagSet& operator=(const FlagSet&) = delete;

  /// Overwrites those that the command line gave; `visit` shows options of the same kind.
  void apply(const VisitAll& visit) const;

 private:
  struct Flag;
  std::vector<Flag> flags_;
};

/// The same for a struct with visit_options.
template <class Options>
class OptionFlags {
 public:
  explicit OptionFlags(CLI::App& command)
      : flags_(command, [this](OptionVisitor& visitor) { visit_options("", values_, visitor); }) {}

  void apply(Options& options) const {
    flags_.apply([&](OptionVisitor& visitor) { visit_options("", options, visitor); });
  }

 private:
  Options values_;  ///< what the flags write into
  FlagSet flags_;
};

}  // namespace vesalius::cli
