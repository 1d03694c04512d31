#include "train/messages/leaf_messages.h"

#include "train/messages/training_messages.h"

namespace vesalius {
namespace {

template <class Number>
void add(std::vector<Number>& all, const std::vector<Number>& other, const char* what) {
  detail::expect_alike(all.size() == other.size(), what);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] += other[i];
}

}  // namespace

void merge(LabelCounts& all, const LabelCounts& other) {
  add(all.classes, other.classes, "classes");
  add(all.headings, other.headings, "headings");
}

void merge(LeafCounts& all, const LeafCounts& other) { add(all.weights, other.weights, "leaves"); }

std::size_t padded_size(const LogitLayout& layout) {
  return (static_cast<std::size_t>(layout.size()) + LeafLogits::kLanes - 1) / LeafLogits::kLanes * LeafLogits::kLanes;
}

void merge(LeafGradient& all, const LeafGradient& other) {
  detail::expect_alike(all.of_trees.size() == other.of_trees.size(), "trees");
  for (std::size_t t = 0; t < all.of_trees.size(); ++t) add(all.of_trees[t], other.of_trees[t], "leaves");
  all.log_likelihood += other.log_likelihood;
  all.weight += other.weight;
}

}  // namespace vesalius
