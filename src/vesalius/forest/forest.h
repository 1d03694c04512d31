#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/base/body_model.h"

namespace vesalius {

/// How node offsets and thresholds are to be read. It is stored in the model file; trainer and detector share it
/// (tree_walk.h), since a forest labels nonsense under any other convention.
struct FeatureConvention {
  float offset_unit = 5e-3F;         ///< one step of a node offset, in pixels times metres at `reference_focal_px`
  float reference_focal_px = 1.F;    ///< 1: offsets are metres across the viewing direction
  std::uint16_t hole_mm = 10000;     ///< what a pixel without reading counts as: far, never near
  std::uint16_t outside_mm = 10000;  ///< what a probe outside the picture reads
  std::uint16_t clip_mm = 0;         ///< probes are clamped to the centre's depth +- this; 0 = not clamped
  friend bool operator==(const FeatureConvention&, const FeatureConvention&) = default;
};

/// Largest offset a node may have, in offset units: keeps the walk's fixed-point product below 2^31 (tree_walk.h).
inline constexpr int kMaxOffset = 1023;

/// An inner node: eq. 1 compared with a threshold.
struct TreeNode {
  std::int16_t du1 = 0, dv1 = 0;  ///< first probe, in offset units
  std::int16_t du2 = 0, dv2 = 0;  ///< second probe
  std::int16_t threshold_mm = 0;  ///< d(first) - d(second) <= threshold goes left
  std::uint16_t unused = 0;
  std::int32_t left = 0;   ///< index of a node; of leaf ~left when negative
  std::int32_t right = 0;  ///< likewise
  friend bool operator==(const TreeNode&, const TreeNode&) = default;
};

/// P_t(c | x) of one leaf: the most likely classes, probabilities in 1/255. Unused slots have probability 0.
struct TreeLeaf {
  static constexpr int kClasses = 4;
  std::array<std::uint8_t, kClasses> label{};  ///< body part; the forest's background class is `part_count`
  std::array<std::uint8_t, kClasses> probability{};
  friend bool operator==(const TreeLeaf&, const TreeLeaf&) = default;
};

/// Nodes in an order where children come after their parent. A tree without nodes is its first leaf.
struct Tree {
  std::vector<TreeNode> nodes;
  std::vector<TreeLeaf> leaves;
  friend bool operator==(const Tree&, const Tree&) = default;
};

/// A trained labeller: what `load_model` returns and a Detector takes.
struct Forest {
  BodyModel body;
  FeatureConvention convention;
  bool has_background = false;  ///< whether class `body.part_count()` is the background
  std::vector<Tree> trees;
  std::string recipe;  ///< free text: how it was made

  int class_count() const { return body.part_count() + (has_background ? 1 : 0); }
};

/// Throws Error where a tree would be walked out of its arrays or names a class the body lacks.
void check(const Forest& forest);

/// Returns the number of edges from the root to the deepest leaf.
int depth(const Tree& tree);

/// Returns whether any leaf holds more than one class. Without, a forest gives single votes, and its labels are
/// smoothed instead of its posteriors.
bool has_distributions(const Forest& forest);

}  // namespace vesalius
