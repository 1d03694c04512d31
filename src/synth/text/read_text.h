#pragma once

#include <functional>
#include <string>

namespace vesalius::synth {

/// Gives the bytes of a file; throws Error naming it. Loaders of several files get one, so that the folder opens none
/// itself.
using ReadText = std::function<std::string(const std::string& path)>;

}  // namespace vesalius::synth
