#pragma once

#include <memory>
#include <string>

#include "vesalius/forest/forest.h"
#include "vesalius/forest/label_pixels.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// --device: what labels pixels.
class DeviceFlag {
 public:
  /// This object must live as long as the command. `group` is where its help stands; empty: among the others.
  explicit DeviceFlag(CLI::App& command, const std::string& group = {});

  /// Returns a labeller on that device (make_labeller), one of those that this build knows. What "auto" decided is said
  /// on standard error.
  std::shared_ptr<const PixelLabeller> make(Forest forest) const;

 private:
  std::string device_ = "cpu";
};

}  // namespace vesalius::cli
