#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vesalius {

/// A regression tree of fixed depth. Node n has the children 2n + 1 and 2n + 2.
struct BoostedTree {
  static constexpr int kDepth = 4;
  static constexpr int kNodes = (1 << kDepth) - 1;
  static constexpr int kLeaves = 1 << kDepth;
  std::array<std::uint16_t, kNodes> feature{};
  std::array<float, kNodes> threshold{};  ///< what is above goes right; infinite where a node does not split
  std::array<float, kLeaves> value{};
  friend bool operator==(const BoostedTree&, const BoostedTree&) = default;
};

/// How probably something is so: the sum of boosted trees over its features (Friedman, Greedy function approximation,
/// 2001). A model has them for two questions: whether a pixel is a body, given what the labeller says around it
/// (body_context.h), and whether a proposal is a person, given the evidence (score_person.h).
struct BoostedTrees {
  int features = 0;  ///< how many numbers are known of what is asked about
  float bias = 0.F;  ///< log odds before any tree
  std::vector<BoostedTree> trees;
  std::vector<std::string> asks = {};  ///< [feature]: its name; none in models of before they had names
  std::string made_from = {};          ///< free text

  bool empty() const { return trees.empty(); }
  /// Writes the logarithm of the odds for each of `count` lists of `features` numbers, one list after the other.
  void log_odds(const float* of, std::size_t count, float* out) const;
  /// Returns the probability, 0-1.
  float probability(const std::vector<float>& of) const;
  friend bool operator==(const BoostedTrees&, const BoostedTrees&) = default;
};

/// Throws Error, which calls them `what`, if a tree asks for a feature that is not there or has a number that is none.
void check(const BoostedTrees& trees, const std::string& what);

/// Returns the same trees for features in the order of `names`. Trees without names have features in this order.
/// Throws Error, which calls them `what`, if they ask for a feature that is not among the names.
BoostedTrees in_order(BoostedTrees trees, const std::vector<std::string>& names, const std::string& what);

}  // namespace vesalius
