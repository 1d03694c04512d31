#include "cli/train/train_trees.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "cli/interrupts.h"
#include "cli/train/grow_display.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"

namespace vesalius::cli {
namespace {

using Slots = std::vector<std::optional<Tree>>;

/// Positions of the trees that are not there.
std::vector<std::size_t> missing_of(const Slots& trees) {
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    if (!trees[i]) missing.push_back(i);
  }
  return missing;
}

}  // namespace

std::vector<Tree> grow_round(const TrainingSet& set, const TrainOptions& options, const TreeRound& round,
                             const TrainSession& session, const std::string& recipe, bool shown, GrowTotals& totals) {
  Slots trees;
  for (int t = 0; t < round.count; ++t) trees.push_back(session.load(round.first + t));
  const std::vector<std::size_t> missing = missing_of(trees);
  totals.resumed += static_cast<int>(trees.size() - missing.size());
  GrowProgress progress;
  GrowDisplay display(round.name, set, static_cast<int>(missing.size()), options.grow.leaf.max_depth, progress, shown);
  const auto grow = [&](std::size_t slot) {
    const int number = round.first + static_cast<int>(slot);
    Tree tree = grow_tree(set, options.grow, number, &progress);
    session.save(number, assemble_forest(set, {tree}, recipe));
    display.add(tree);  // a copy: what it shows may come late
    trees[slot] = std::move(tree);
  };
  try {
    // In batches: a thread that waits within a tree may otherwise begin another one, and hold the memory of both.
    for (std::size_t begin = 0; begin < missing.size(); begin += static_cast<std::size_t>(round.at_once)) {
      const std::size_t count = std::min(missing.size() - begin, static_cast<std::size_t>(round.at_once));
      parallel_for(static_cast<int>(count), [&](int i) { grow(missing[begin + static_cast<std::size_t>(i)]); });
    }
  } catch (const Error&) {
    if (!interrupted()) throw;
    throw Error(fmt::format("interrupted, {} of {} trees of the {} are in {}: the same command goes on",
                            trees.size() - missing_of(trees).size(), trees.size(), round.name, session.folder()));
  }
  totals.evaluations += progress.evaluations;
  totals.seconds += display.seconds();
  std::vector<Tree> grown;
  for (std::optional<Tree>& tree : trees) grown.push_back(std::move(*tree));
  return grown;
}

}  // namespace vesalius::cli
