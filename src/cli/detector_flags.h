#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cli/option_flags.h"
#include "vesalius/detect.h"

namespace vesalius::cli {

/// Flags that say which detector: --model, --body, --options and one for every detector option.
class DetectorFlags {
 public:
  /// Must live as long as the command.
  explicit DetectorFlags(CLI::App& command);

  /// Throws Error for files that cannot be used, UsageError for options outside their range.
  Detector make() const;
  const std::string& model() const { return model_; }

 private:
  std::string model_, body_, options_file_;
  OptionFlags<DetectOptions> options_;
};

/// --threads of every command: how many there may be.
inline constexpr int kMaxThreads = 1024;
inline constexpr const char* kDetectorGroup = "Detector";

}  // namespace vesalius::cli
