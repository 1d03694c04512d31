#pragma once

#include <cstdint>

#include "train/frame_store.h"
#include "train/split_candidates.h"
#include "train/training_set.h"

namespace vesalius {

/// Eq. 1 at one sample for all candidates of a table, whose columns (CandidateTable::offsets) have `padded` values
/// each: `values` takes as many, in mm, clamped to int16. The same numbers from every instruction set.
void evaluate_candidates(const TiledDepth& depth, const FeatureConvention& convention, const TrainingSample& sample,
                         const std::int16_t* offsets, int padded, std::int16_t* values);
/// The same numbers without unpacking the frame: quicker for few samples of it.
void evaluate_candidates(const FrameStore::View& view, const FeatureConvention& convention,
                         const TrainingSample& sample, const std::int16_t* offsets, int padded, std::int16_t* values);

}  // namespace vesalius
