#pragma once

#include <string>

#include "train/samples/huge_buffer.h"
#include "train/samples/training_set.h"

namespace vesalius {

/// Returns a set's frames and samples as bytes with a checksum (docs/formats.md).
std::string training_set_bytes(const TrainingSet& set);

/// Adds what such bytes hold behind what `contents` has, whose frames stay where they lie in the buffer. Throws Error
/// naming `name` if the bytes are damaged or of another version.
void append_training_set(HugeBuffer buffer, const std::string& name, TrainingSet::Contents& contents);

}  // namespace vesalius
