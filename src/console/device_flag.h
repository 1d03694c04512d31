#pragma once

#include <string>

#include "vesalius/model.h"

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

}  // namespace vesalius::cli
