#pragma once

#include <string>
#include <string_view>

#include "train/training_set.h"

namespace vesalius {

/// Returns a set's frames and samples as bytes with a checksum (docs/formats.md).
std::string training_set_bytes(const TrainingSet& set);

/// Adds what such bytes hold behind what `contents` has. Throws Error naming `name` if the bytes are damaged or of
/// another version.
void append_training_set(std::string_view bytes, const std::string& name, TrainingSet::Contents& contents);

}  // namespace vesalius
