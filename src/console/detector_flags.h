#pragma once

#include <string>

#include "console/option_flags.h"
#include "vesalius/detect.h"
#include "vesalius/model.h"
#include "vesalius/track_people.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// --device: what labels pixels.
class DeviceFlag {
 public:
  /// This object must live as long as the command. `group` is where its help stands; empty: among the others.
  explicit DeviceFlag(CLI::App& command, const std::string& group = {});

  /// Returns the model with a labeller on that device (on_device), one of those that this build knows. What "auto"
  /// decided is said on standard error.
  Model make(Model model) const;

 private:
  std::string device_ = "cpu";
};

/// Returns the default options, changed first by the TOML file (if the path is not empty) and then by the flags. Throws
/// Error for a file that cannot be used and UsageError for options outside their range.
PeopleOptions people_options(const std::string& options_file, const OptionFlags<PeopleOptions>& flags);

/// Replaces the model's body by that of a file with the same parts but another kinematic tree or other joints. Throws
/// Error for a file that cannot be used or has other parts.
void replace_body(Model& model, const std::string& path);

/// The flags that define a detector: --model, --body, --device, --options and one for every option of detector,
/// tracking and fitted bodies.
class DetectorFlags {
 public:
  /// This object must live as long as the command.
  explicit DetectorFlags(CLI::App& command);

  /// Makes the detector. Throws Error for files that cannot be used, UsageError for options outside their range, and
  /// DeviceError if there is no such device.
  Detector make() const;
  /// The parts of which `make` makes it, with the options of tracking and of fitted bodies.
  PeopleOptions options() const;
  /// Returns the model with its labeller. Throws DeviceError if there is no such device.
  Model loaded() const;
  /// Returns the path of the model. Throws Error if none is given and there is no default model.
  std::string model() const;

 private:
  std::string model_, body_, options_file_;
  DeviceFlag device_;
  OptionFlags<PeopleOptions> options_;
};

inline constexpr const char* kDetectorGroup = "Detector";

}  // namespace vesalius::cli
