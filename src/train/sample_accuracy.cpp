#include "train/sample_accuracy.h"

#include <numeric>

#include "train/sample_votes.h"
#include "train/walk_samples.h"

namespace vesalius {
namespace {

double mean_part_recall(const Confusion& confusion, int part_count) {
  double sum = 0.0;
  int parts = 0;
  for (int part = 0; part < part_count; ++part) {
    if (confusion.row_sum(part) == 0) continue;
    sum += confusion.recall(part);
    ++parts;
  }
  return parts > 0 ? sum / parts : 0.0;
}

}  // namespace

std::uint64_t Confusion::row_sum(int truth) const {
  const auto row = counts.begin() + static_cast<std::ptrdiff_t>(index(truth, 0));
  return std::accumulate(row, row + classes, std::uint64_t{0});
}

double Confusion::recall(int truth) const {
  const std::uint64_t sum = row_sum(truth);
  return sum > 0 ? static_cast<double>(at(truth, truth)) / static_cast<double>(sum) : 0.0;
}

// `parts` has one class for each part, so its size says how many of `all` are parts.
double SampleAccuracy::with_background() const { return mean_part_recall(all, parts.classes); }
double SampleAccuracy::parts_only() const { return mean_part_recall(parts, parts.classes); }

HeldOutVotes::HeldOutVotes(const TrainingSet& set)
    : set_(set), sums_(set.held_out().size() * static_cast<std::size_t>(set.class_count()), 0) {}

void HeldOutVotes::add(const Tree& tree) {
  const std::span<const TrainingSample> samples = set_.held_out();
  const auto classes = static_cast<std::size_t>(set_.class_count());
  for_sample_ranges(samples.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TreeLeaf& leaf = tree.leaves[leaf_of(tree, set_.frames(), samples[i])];
      for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) {
        std::uint16_t& sum = sums_[i * classes + leaf.label[k]];
        sum = static_cast<std::uint16_t>(sum + leaf.probability[k]);
      }
    }
  });
  ++trees_;
}

SampleAccuracy HeldOutVotes::accuracy() const {
  const auto classes = static_cast<std::size_t>(set_.class_count());
  return accuracy_of_votes(set_, set_.held_out(), [&](std::size_t i) { return sums_.data() + i * classes; });
}

std::vector<AccuracyPoint> accuracy_by_trees(const Forest& forest, const TrainingSet& set) {
  HeldOutVotes votes(set);
  std::vector<AccuracyPoint> points;
  for (const Tree& tree : forest.trees) {
    votes.add(tree);
    const SampleAccuracy accuracy = votes.accuracy();
    points.push_back({accuracy.with_background(), accuracy.parts_only()});
  }
  return points;
}

}  // namespace vesalius
