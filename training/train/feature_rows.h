#pragma once

#include <cstddef>
#include <cstdint>

#include "train/messages/training_messages.h"
#include "train/samples/frame_store.h"

namespace vesalius {

/// The values of up to kBlockCandidates candidates at samples of one node. Each row has `width` numbers (mm).
struct FeatureRows {
  const std::int16_t* values = nullptr;
  const std::uint8_t* labels = nullptr;  ///< class of each row
  std::size_t rows = 0;
  int width = 0;  ///< a multiple of 16, at most kBlockCandidates
};

/// Computes eq. 1 at one sample for all candidates of a table, whose columns (CandidateTable::offsets) have `padded`
/// values each. `values` takes as many, in mm, clamped to int16. The numbers are the same from every instruction set.
void evaluate_candidates(const TiledDepth& depth, const FeatureConvention& convention, const TrainingSample& sample,
                         const std::int16_t* offsets, int padded, std::int16_t* values);
/// Computes the same numbers without unpacking the frame, which is faster for few samples of it.
void evaluate_candidates(const FrameStore::View& view, const FeatureConvention& convention,
                         const TrainingSample& sample, const std::int16_t* offsets, int padded, std::int16_t* values);

}  // namespace vesalius
