#pragma once

// Accuracy of a forest on samples, which are drawn pixels and no whole pictures: good for comparing forests on the same
// samples, not beside figures over all pixels of a picture.

#include <cstdint>
#include <span>
#include <vector>

#include "train/training_set.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// How often samples of a true class (row) were given a class (column).
struct Confusion {
  int classes = 0;
  std::vector<std::uint64_t> counts;  ///< classes x classes, row after row

  explicit Confusion(int class_count = 0)
      : classes(class_count), counts(static_cast<std::size_t>(class_count) * static_cast<std::size_t>(class_count)) {}
  std::uint64_t at(int truth, int given) const { return counts[index(truth, given)]; }
  std::uint64_t& at(int truth, int given) { return counts[index(truth, given)]; }
  /// Samples of a true class.
  std::uint64_t row_sum(int truth) const;
  /// Share of a true class that was given right, 0 to 1; 0 where it has no sample.
  double recall(int truth) const;

 private:
  std::size_t index(int truth, int given) const {
    return static_cast<std::size_t>(truth) * static_cast<std::size_t>(classes) + static_cast<std::size_t>(given);
  }
};

struct SampleAccuracy {
  Confusion all;    ///< of all classes: the background, where the forest has it, is a rival of the parts
  Confusion parts;  ///< samples of parts only, which may be given parts only: free of the background's prior

  /// Mean recall of the parts that have samples, 0 to 1; 0 without any.
  double with_background() const;
  double parts_only() const;
};

/// Adds up the posteriors of a set's held-out samples, tree by tree (eq. 2). Not for several threads at once; each call
/// uses all of them. The counts do not depend on how many.
class HeldOutVotes {
 public:
  /// `set` must outlive this.
  explicit HeldOutVotes(const TrainingSet& set);
  void add(const Tree& tree);
  int trees() const { return trees_; }
  /// The most probable class of each, the lower one on a tie.
  SampleAccuracy accuracy() const;

 private:
  const TrainingSet& set_;
  int trees_ = 0;
  std::vector<std::uint16_t> sums_;  ///< [sample][class], in 1/255
};

/// Both mean recalls of some part of a forest.
struct AccuracyPoint {
  double with_background = 0.0;
  double parts_only = 0.0;
};

/// Of the first tree, the first two, ... of the forest on the held-out samples.
std::vector<AccuracyPoint> accuracy_by_trees(const Forest& forest, const TrainingSet& set);

/// Of the forest cut at level 0, 1, ... of its deepest tree: an inner node answers with the classes of the training
/// samples that pass through it. Measured on at most 20,000 held-out samples, evenly chosen.
std::vector<AccuracyPoint> accuracy_by_level(const Forest& forest, const TrainingSet& set);

}  // namespace vesalius
