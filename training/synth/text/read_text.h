#pragma once

#include <functional>
#include <string>

namespace vesalius::synth {

/// A function that returns the bytes of a file and throws Error naming it. Loaders of several files get one, so that
/// training/synth opens no file itself.
using ReadText = std::function<std::string(const std::string& path)>;

}  // namespace vesalius::synth
