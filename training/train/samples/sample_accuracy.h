#pragma once

// The accuracy of a forest on samples. Samples are drawn pixels, so these numbers can be compared between forests on
// the same samples, but not with metrics over all pixels of a picture.

#include <cstdint>
#include <span>
#include <vector>

#include "train/samples/training_set.h"
#include "vesalius/forest.h"

namespace vesalius {

/// The numbers of samples of each true class (row) that were given each class (column).
struct Confusion {
  int classes = 0;
  std::vector<std::uint64_t> counts;  ///< classes x classes, row by row

  explicit Confusion(int class_count = 0) : classes(class_count), counts(std::size_t{1} * class_count * class_count) {}
  std::uint64_t at(int truth, int given) const { return counts[index(truth, given)]; }
  std::uint64_t& at(int truth, int given) { return counts[index(truth, given)]; }
  /// Returns the number of samples of a true class.
  std::uint64_t row_sum(int truth) const;
  /// Returns the share of a true class that was given right, 0 to 1; 0 where the class has no sample.
  double recall(int truth) const;

 private:
  std::size_t index(int truth, int given) const { return std::size_t{1} * truth * classes + given; }
};

/// The result of a forest on samples, with and without the background as a rival of the parts.
struct SampleAccuracy {
  Confusion all;    ///< over all classes, with the background if the forest has one
  Confusion parts;  ///< over samples of parts, each given the likeliest part

  /// Both return the mean recall, 0 to 1, of the parts that have samples; 0 if none has.
  double with_background() const;
  double parts_only() const;
};

/// Adds up the posteriors of a set's held-out samples tree by tree (eq. 2). It is called from one thread at a time, and
/// each call uses all allowed threads. The counts do not depend on the number of threads.
class HeldOutVotes {
 public:
  /// `set` must outlive this.
  explicit HeldOutVotes(const TrainingSet& set);
  void add(const Tree& tree);
  int trees() const { return trees_; }
  /// Compares the most probable class of each sample, the lower one on a tie, with the truth.
  SampleAccuracy accuracy() const;

 private:
  const TrainingSet& set_;
  int trees_ = 0;
  std::vector<std::uint16_t> sums_;  ///< [sample][class], in 1/255
};

/// Returns the accuracy of a whole forest on the held-out samples, by its logits if it has them.
SampleAccuracy held_out_accuracy(const Forest& forest, const TrainingSet& set);

/// The two mean recalls of a part of a forest.
struct AccuracyPoint {
  double with_background = 0.0;
  double parts_only = 0.0;
};

/// Returns the accuracy of the first tree, of the first two trees and so on, on the held-out samples.
std::vector<AccuracyPoint> accuracy_by_trees(const Forest& forest, const TrainingSet& set);

/// Returns the accuracy of the forest cut off at level 0, 1, ... of its deepest tree, where an inner node answers with
/// the classes of the training samples that pass through it. It is measured on at most 20,000 evenly chosen held-out
/// samples.
std::vector<AccuracyPoint> accuracy_by_level(const Forest& forest, const TrainingSet& set);

}  // namespace vesalius
