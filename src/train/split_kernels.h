#pragma once

#include <cstdint>

#include "train/entropy_table.h"
#include "train/feature_rows.h"
#include "train/training_messages.h"

namespace vesalius::kernels {

// Inner loops of split_histogram.h for the instruction set at hand; the same numbers from each of them.

/// low, high: `rows.width` values, updated.
void update_ranges(const FeatureRows& rows, std::int16_t* low, std::int16_t* high);

/// class_of[class] is the renumbered class.
void count_rows(const FeatureRows& rows, const Binning& binning, const std::uint8_t* class_of, std::uint16_t* counts);

/// Best score and bin of each of kBlockCandidates candidates; score INT32_MIN where no threshold leaves `least` on
/// both sides. totals: samples of each renumbered class.
void scan_bins(const SplitHistogram& histogram, const std::int32_t* totals, std::int32_t least,
               const EntropyTable& entropy, std::int32_t* scores, std::int32_t* bins);

}  // namespace vesalius::kernels
