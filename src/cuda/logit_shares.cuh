#pragma once

// How logits become shares, with the operations of leaf_logits.cpp: what the kernels of labelling and training have in
// common.

#include "cuda/gpu.h"

namespace vesalius::gpu {

/// exp of x in [-80, 80], by the operations of leaf_logits.cpp.
GPU_FUNCTION float exponential(float x) {
  const float scaled = x * 1.44269504F;
  const std::int32_t whole = nearest(scaled);
  const float rest = (scaled - float(whole)) * 0.693147181F;
  float sum = 1.F / 120.F;
  sum = sum * rest + 1.F / 24.F;
  sum = sum * rest + 1.F / 6.F;
  sum = sum * rest + 0.5F;
  sum = sum * rest + 1.F;
  sum = sum * rest + 1.F;
  return sum * bits_as_float((whole + 127) << 23);
}

/// Numbers in the order of the floats that they stand for, so that integers can be compared, and back.
GPU_FUNCTION std::int32_t ordered(float x) {
  const std::int32_t bits = float_as_bits(x);
  return bits >= 0 ? bits : bits ^ 0x7FFFFFFF;
}
GPU_FUNCTION float unordered(std::int32_t bits) { return bits_as_float(bits >= 0 ? bits : bits ^ 0x7FFFFFFF); }

/// Returns the power of a logit relative to the largest of its group.
GPU_FUNCTION float power_below(float logit, std::int32_t ordered_top) {
  float x = logit - unordered(ordered_top);
  x = x > -80.F ? x : -80.F;
  return exponential(x < 0.F ? x : 0.F);
}

/// What the groups of a pixel's places have in common: the parts of each side, the background, the headings of each
/// side (leaf_logits.cpp).
struct LogitGroups {
  static constexpr int kCount = 8;  // one is not used
  static constexpr int kBackground = 3;
  static constexpr int kFirstTurn = 4;
  static constexpr int kSides = 3;
  static constexpr float kFixed = 8388608.F;
  static constexpr float kAbsent = -1e30F;
};

/// Writes by what the powers of each group are multiplied to become posteriors.
GPU_FUNCTION void scale_groups(const float* tops, const std::int32_t* fixed, bool has_turns, float* scales) {
  using G = LogitGroups;
  float sum[G::kCount], together[G::kSides + 1];
  for (int g = 0; g < G::kCount; ++g) sum[g] = float(fixed[g]) / G::kFixed;
  for (int s = 0; s < G::kSides; ++s) {
    if (!has_turns) sum[G::kFirstTurn + s] = 1.F;
    together[s] = tops[s] + (has_turns ? tops[G::kFirstTurn + s] : 0.F);
  }
  together[G::kBackground] = tops[G::kBackground];
  float top = together[0];
  for (int k = 1; k <= G::kBackground; ++k) top = together[k] > top ? together[k] : top;
  for (int k = 0; k <= G::kBackground; ++k) {
    const float below = together[k] - top;
    together[k] = exponential(below > -80.F ? below : -80.F);
  }
  float all = together[G::kBackground] * sum[G::kBackground];
  for (int s = 0; s < G::kSides; ++s) all += together[s] * sum[s] * sum[G::kFirstTurn + s];
  scales[G::kBackground] = together[G::kBackground] / all;
  for (int s = 0; s < G::kSides; ++s) {
    scales[s] = together[s] * sum[G::kFirstTurn + s] / all;
    scales[G::kFirstTurn + s] = together[s] * sum[s] / all;
  }
}

}  // namespace vesalius::gpu
