#pragma once

#include <string>
#include <string_view>

#include "train/training_set.h"

namespace vesalius {

/// Returns a set's frames and samples as bytes with a checksum (docs/formats.md).
std::string training_set_bytes(const TrainingSet& set);

/// Returns the set of such bytes; the other arguments are those it was drawn with. Throws Error naming `name` if the
/// bytes are damaged or of another version.
TrainingSet parse_training_set(std::string_view bytes, const std::string& name, const BodyModel& body,
                               const FeatureConvention& convention, const SampleOptions& options, std::uint64_t seed,
                               std::size_t first_frame);

}  // namespace vesalius
