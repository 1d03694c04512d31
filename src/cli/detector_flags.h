#pragma once

#include <string>

#include "cli/option_flags.h"
#include "vesalius/detect.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// The defaults, what the TOML file (empty: none) says, then the flags. Throws Error for a file that cannot be used,
/// UsageError for options outside their range.
DetectOptions detect_options(const std::string& options_file, const OptionFlags<DetectOptions>& flags);

/// Flags that say which detector: --model, --body, --options and one for every detector option.
class DetectorFlags {
 public:
  /// Must live as long as the command.
  explicit DetectorFlags(CLI::App& command);

  /// Throws Error for files that cannot be used, UsageError for options outside their range.
  Detector make() const;
  /// Returns the path of the model. Throws Error where none is given and there is no default one.
  std::string model() const;

 private:
  std::string model_, body_, options_file_;
  OptionFlags<DetectOptions> options_;
};

inline constexpr const char* kDetectorGroup = "Detector";

}  // namespace vesalius::cli
