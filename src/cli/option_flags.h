#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "vesalius/detect.h"

namespace vesalius::cli {

/// A flag for every detector option, e.g. --search.min-parts. They are left out of --help (there are many;
/// `vesalius options` lists them) and known to shell completion.
class OptionFlags {
 public:
  explicit OptionFlags(CLI::App& command);
  ~OptionFlags();
  OptionFlags(const OptionFlags&) = delete;
  OptionFlags& operator=(const OptionFlags&) = delete;

  /// Overwrites those that the command line gave.
  void apply(DetectOptions& options) const;

 private:
  struct Flag;
  DetectOptions values_;  ///< what the flags write into
  std::vector<Flag> flags_;
};

}  // namespace vesalius::cli
