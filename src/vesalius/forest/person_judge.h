#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vesalius {

/// A regression tree of fixed depth. Node n has the children 2n + 1 and 2n + 2.
struct JudgeTree {
  static constexpr int kDepth = 4;
  static constexpr int kNodes = (1 << kDepth) - 1;
  static constexpr int kLeaves = 1 << kDepth;
  std::array<std::uint16_t, kNodes> feature{};
  std::array<float, kNodes> threshold{};  ///< what is above goes right; infinite where a node does not split
  std::array<float, kLeaves> value{};
  friend bool operator==(const JudgeTree&, const JudgeTree&) = default;
};

/// How probably a proposal is a person: the sum of boosted trees over its evidence (Friedman, Greedy function
/// approximation, 2001). It belongs to a forest, since it was fitted to what that forest says of people and of rooms.
struct PersonJudge {
  int features = 0;  ///< length of the evidence (judge_features)
  float bias = 0.F;  ///< log odds before any tree
  std::vector<JudgeTree> trees;

  bool empty() const { return trees.empty(); }
  /// Returns the probability of a person, 0-1, for a list of `features` numbers.
  float probability(const std::vector<float>& evidence) const;
  friend bool operator==(const PersonJudge&, const PersonJudge&) = default;
};

/// Throws Error if a tree looks at evidence that is not there, or has a number that is none.
void check(const PersonJudge& judge);

}  // namespace vesalius
