#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/body_model.h"

namespace vesalius {

/// The meaning of node offsets and thresholds. It is stored in the model file and shared by trainer and detector
/// (tree_walk.h), because with any other convention a forest's labels are meaningless.
struct FeatureConvention {
  float offset_unit = 5e-3F;         ///< one step of a node offset, in pixels times metres at `reference_focal_px`
  float reference_focal_px = 1.F;    ///< at 1, offsets are metres perpendicular to the viewing direction
  std::uint16_t hole_mm = 10000;     ///< depth that stands for a pixel without reading; it is far, never near
  std::uint16_t outside_mm = 10000;  ///< depth that a probe outside the picture reads
  std::uint16_t clip_mm = 0;         ///< probes are clamped to the centre's depth +- this; 0 = not clamped
  friend bool operator==(const FeatureConvention&, const FeatureConvention&) = default;
};

/// Largest offset of a node in offset units. It keeps the walk's fixed-point product below 2^31 (tree_walk.h).
inline constexpr int kMaxOffset = 1023;

/// An inner node: eq. 1 compared with a threshold.
struct TreeNode {
  std::int16_t du1 = 0, dv1 = 0;  ///< first probe, in offset units
  std::int16_t du2 = 0, dv2 = 0;  ///< second probe
  std::int16_t threshold_mm = 0;  ///< d(first) - d(second) <= threshold goes left
  std::uint16_t unused = 0;
  std::int32_t left = 0;   ///< index of a node, or ~index of a leaf if negative
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

/// A tree. Children come after their parent; a tree without nodes is its first leaf.
struct Tree {
  std::vector<TreeNode> nodes;
  std::vector<TreeLeaf> leaves;
  /// Where leaves were learned jointly, their logits (leaf_logits.h) in the forest's unit: [leaf][LogitLayout]. They
  /// then take the place of the leaves' classes, which model files leave out.
  std::vector<std::int8_t> logits = {};
  friend bool operator==(const Tree&, const Tree&) = default;
};

/// A softmax regression of a person's heading over what leaves say of it (facing.h). Without weights nothing is
/// decided.
struct FacingModel {
  int headings = 0;
  int parts = 0;
  std::vector<float> weights;  ///< [heading][feature]
  std::string made_from = {};  ///< free text

  bool empty() const { return weights.empty(); }
  /// Returns the number of features: for each part how likely each heading is, the part's share, and a constant.
  std::size_t features() const { return std::size_t{1} * parts * headings + parts + 1; }
  friend bool operator==(const FacingModel&, const FacingModel&) = default;
};

/// Throws Error if a regression that is not empty is for other parts or headings or has a weight that is no number.
void check(const FacingModel& model, int parts, int headings);

/// Trees that label pixels, as training returns them (vesalius/model.h).
struct Forest {
  BodyModel body;
  FeatureConvention convention;
  bool has_background = false;  ///< whether class `body.part_count()` is the background
  std::vector<Tree> trees;
  float logit_unit = 0.F;  ///< unit of the leaves' logits in nats; 0 where leaves have distributions instead
  int headings = 0;        ///< headings that the leaves' logits tell apart
  FacingModel facing;      ///< how a person's heading follows from them; may be empty
  std::string recipe;      ///< free text on how it was made

  int class_count() const { return body.part_count() + (has_background ? 1 : 0); }
};

/// Throws Error if a walk could leave the arrays of a tree, or if a tree names a class that the body lacks.
void check(const Forest& forest);

/// Returns the number of edges from the root to the deepest leaf.
int depth(const Tree& tree);

/// Returns whether any leaf has more than one class. Otherwise each tree gives a single vote.
bool has_distributions(const Forest& forest);

}  // namespace vesalius
