#pragma once

// Leaves that were learned jointly (Ren et al., Global refinement of random forest, CVPR 2015; here with headings).
//
// A leaf holds logits instead of a distribution. A pixel's logits are the sums over the leaves that it reaches, one of
// each tree, and its posteriors are their softmax over the background and over all pairs of a part and a heading:
//   P(part, heading) ~ exp(class[part] + turn[side of part][heading]),  P(background) ~ exp(class[background]).
// What a heading changes is mostly which of two mirrored parts a pixel is. So the headings' logits belong to the three
// sides of a body, not to single parts, and a leaf stays small.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vesalius/body_model.h"

namespace vesalius {

/// The sides of a body that a part can belong to.
inline constexpr int kSides = 3;

/// Where the logits of a leaf are: first the classes, then for each side the headings.
struct LogitLayout {
  int parts = 0;
  bool background = false;         ///< whether the class after the parts is the background
  int headings = 0;                ///< headings that are told apart; may be 0
  std::vector<std::uint8_t> side;  ///< [part]: 0 on the middle line, 1 left, 2 right

  LogitLayout() = default;
  LogitLayout(const BodyModel& body, bool has_background, int heading_count);

  int classes() const { return parts + (background ? 1 : 0); }
  int turn(int of_side, int heading) const { return classes() + of_side * headings + heading; }
  int size() const { return classes() + kSides * headings; }
};

/// The softmax of a pixel's logits. Its bits do not depend on the instruction set.
class LogitSoftmax {
 public:
  /// Vectors of logits and shares are padded to a multiple of so many numbers.
  static constexpr std::size_t kLanes = 16;

  explicit LogitSoftmax(LogitLayout layout);
  const LogitLayout& layout() const { return layout_; }
  /// Returns the numbers of a padded vector.
  std::size_t padded() const { return group_.size(); }

  /// Turns `padded()` logits in the layout's order, and zeros behind them, into shares in place: the posteriors of the
  /// classes, then the joint posteriors of sides and headings.
  void operator()(float* values) const;

 private:
  LogitLayout layout_;
  /// [place]: side of a part 0 to 2, background 3, 4 + side of a heading, 7 behind the last.
  std::vector<std::int32_t> group_;
};

/// Reads posteriors from leaves' logits. Each thread needs its own.
class LogitReader {
 public:
  /// `unit` is that of the logits in nats.
  LogitReader(const LogitLayout& layout, float unit, int trees);

  std::size_t padded() const { return softmax_.padded(); }

  /// Writes the posteriors of the classes in 1/(255 trees), and P(side, heading | body) in 1/65535 (Posteriors).
  /// `leaves` has each tree's leaf, of which `padded()` logits can be read.
  void read(const std::int8_t* const* leaves, std::uint16_t* posteriors, std::uint16_t* turns);

 private:
  LogitSoftmax softmax_;
  float unit_;
  std::size_t trees_;
  float whole_;
  std::vector<float> shares_;
};

}  // namespace vesalius
