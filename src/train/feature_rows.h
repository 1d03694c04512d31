#pragma once

#include <cstdint>

#include "train/frame_store.h"
#include "train/split_candidates.h"
#include "train/training_set.h"

namespace vesalius {

/// Eq. 1 at one sample for all candidates of a table, whose columns (CandidateTable::offsets) have `padded` values
/// each: `values` takes as many, in mm, clamped to int16. The same numbers from every instruction set.
void evaluate_candidates(const FrameStore::View& view, const FeatureConvention& convention,
                         const TrainingSample& sample, const std::int16_t* offsets, int padded, std::int16_t* values);

/// Name of the instruction set that `evaluate_candidates` runs on here, e.g. AVX3.
const char* training_target();

}  // namespace vesalius
