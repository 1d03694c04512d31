#pragma once

#include <cstdint>

#include "train/feature_rows.h"
#include "train/messages/training_messages.h"

namespace vesalius::kernels {

// The inner loops of split_histogram.h for the processor's instruction set. All instruction sets give the same numbers.

/// Extends `low` and `high`, of `rows.width` values each, to the values of the rows.
void update_ranges(const FeatureRows& rows, std::int16_t* low, std::int16_t* high);

/// Adds the rows to `counts`, which have the layout of SplitHistogram; class_of[class] is the renumbered class.
void count_rows(const FeatureRows& rows, const Binning& binning, const std::uint8_t* class_of, std::uint16_t* counts);

/// Writes the best score and bin of each of kBlockCandidates candidates; the score is INT32_MIN if no threshold leaves
/// `least` samples on both sides. `totals` are the samples of each renumbered class.
void scan_bins(const SplitHistogram& histogram, const std::int32_t* totals, std::int32_t least,
               const EntropyTable& entropy, std::int32_t* scores, std::int32_t* bins);

}  // namespace vesalius::kernels
