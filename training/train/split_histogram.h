#pragma once

// The choice of a node's split. A shard makes replies from its rows of feature values (node_values, count_bins,
// values_in). The driver chooses from the merged replies (best_split, refine_split) and sees no row.

#include "train/feature_rows.h"
#include "train/messages/training_messages.h"

namespace vesalius {

/// Returns how many of the rows each of `classes` classes has, and the range of each candidate's values.
NodeValues node_values(const FeatureRows& rows, int classes);

/// Returns the rows counted by class, candidate and bin. The rows are at most kMostCounted and have no other classes
/// and values than the merged NodeValues that the task was made of.
SplitHistogram count_bins(const FeatureRows& rows, const CountTask& task);

/// Returns the rows whose value lies in an interval.
IntervalValues values_in(const FeatureRows& rows, const ValueInterval& interval);

/// Returns the best split over the first `candidates` candidates; on a tie the first candidate, then the lowest bin.
BinSplit best_split(const SplitHistogram& histogram, int candidates, const ClassIndex& classes, int least,
                    const EntropyTable& entropy);
/// Returns the same with the samples below its bin.
BinChoice choose_bin(const SplitHistogram& histogram, int candidates, const ClassIndex& classes, int least,
                     const EntropyTable& entropy);

/// Returns the interval of the values in the bins on either side of a split.
ValueInterval beside(const BinSplit& split, const Binning& binning, int node);

/// A threshold in mm and its gain in bits per sample.
struct ThresholdSplit {
  int threshold_mm = 0;
  double gain = 0;
};

/// Returns the best threshold of the chosen candidate in the bins on either side of `choice`: midway between two
/// consecutive values, the lowest on a tie. `values` are those of `beside`.
ThresholdSplit refine_split(IntervalValues values, const BinChoice& choice, const ClassIndex& classes, int least,
                            const EntropyTable& entropy);

/// The choice of a split from all rows of a node at once.
struct RowSplit {
  int candidate = -1;  ///< -1 if no threshold leaves `least` rows on both sides
  ThresholdSplit threshold;
};

/// Returns the split among the first `candidates` candidates that the steps above choose together.
RowSplit split_of(const FeatureRows& rows, int classes, int bins, int candidates, int least,
                  const EntropyTable& entropy);

}  // namespace vesalius
