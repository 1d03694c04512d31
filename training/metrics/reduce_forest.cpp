#include "metrics/reduce_forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>

#include "vesalius/base/error.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {

Forest with_hard_votes(Forest forest) {
  const LogitLayout layout(forest.body, forest.has_background, forest.headings);
  for (Tree& tree : forest.trees) {
    for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
      TreeLeaf& leaf = tree.leaves[i];
      if (tree.logits.empty()) {
        const auto best = std::ranges::max_element(leaf.probability) - leaf.probability.begin();
        leaf = {{leaf.label[best]}, {255}};
      } else {
        const std::int8_t* logits = tree.logits.data() + i * static_cast<std::size_t>(layout.size());
        leaf = {{static_cast<std::uint8_t>(std::max_element(logits, logits + layout.classes()) - logits)}, {255}};
      }
    }
    tree.logits.clear();
  }
  forest.logit_unit = 0.F;
  forest.headings = 0;
  forest.facing = {};
  return forest;
}

Forest with_first_trees(const Forest& forest, int count) {
  if (count < 1 || count > std::ssize(forest.trees)) {
    throw Error(fmt::format("{} of {} trees, expected at least one and at most all", count, forest.trees.size()));
  }
  Forest reduced = forest;
  reduced.trees.resize(static_cast<std::size_t>(count));
  return reduced;
}

}  // namespace vesalius
