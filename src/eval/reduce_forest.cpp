#include "eval/reduce_forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "vesalius/base/error.h"

namespace vesalius {

Forest with_hard_votes(Forest forest) {
  for (Tree& tree : forest.trees) {
    for (TreeLeaf& leaf : tree.leaves) {
      const auto best = std::ranges::max_element(leaf.probability) - leaf.probability.begin();
      leaf = {{leaf.label[best]}, {255}};
    }
  }
  return forest;
}

Forest with_first_trees(const Forest& forest, int count) {
  if (count < 1 || count > std::ssize(forest.trees)) {
    throw Error(fmt::format("{} of {} trees, expected at least one and at most all", count, forest.trees.size()));
  }
  Forest reduced;
  reduced.body = forest.body;
  reduced.convention = forest.convention;
  reduced.has_background = forest.has_background;
  reduced.trees.assign(forest.trees.begin(), forest.trees.begin() + count);
  return reduced;
}

}  // namespace vesalius
