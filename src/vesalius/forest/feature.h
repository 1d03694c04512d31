#pragma once

// Equation 1 of the paper, written once. Plain C++17 that includes nothing of vesalius, so that every compiler takes
// it, those of devices too. The walk of single pixels (tree_walk.h), the scalar kernel (walk_kernels.cpp) and the
// trainer use it; their versions on vectors are tested against it. It works on integers: the same value on every
// machine.

#include <cstdint>

namespace vesalius {

/// Pixels per unit of a node's offset at one depth, in 1/65536 pixel. The further away, the smaller, so that a feature
/// covers the same part of a body at any distance.
struct OffsetScale {
  std::int32_t u = 0;
  std::int32_t v = 0;
};

/// The scale that a unit of offset never exceeds: 32 pixels.
inline constexpr double kMaxOffsetScale = 32.0 * 65536.0;

/// Returns the scale along one axis at `depth_mm`, which must be above 0: `unit` is that of 1 mm (OffsetScaler).
constexpr std::int32_t offset_scale(double unit, int depth_mm) {
  const double scale = unit / depth_mm;
  return static_cast<std::int32_t>(scale < kMaxOffsetScale ? scale : kMaxOffsetScale);
}

/// Millimetres that the probes of one pixel are clamped to.
struct ProbeRange {
  int low_mm = 0;
  int high_mm = 65535;
};

/// Returns the range of a pixel at `depth_mm`: its depth plus and minus `clip_mm`, or everything for 0.
constexpr ProbeRange probe_range(int depth_mm, int clip_mm) {
  return clip_mm != 0 ? ProbeRange{depth_mm - clip_mm, depth_mm + clip_mm} : ProbeRange{};
}

/// Returns the column or row that a probe reads, rounded to the nearest: `offset` units of `scale` away from `pixel`.
/// |offset * scale| must stay below 2^31.
constexpr int probe_place(int pixel, int offset, std::int32_t scale) {
  return pixel + ((offset * scale + 32768) >> 16);
}

/// Returns the feature of pixel (u, v), in millimetres: the difference of its two probes, each clamped to `range`.
/// `offsets` has the members du1, dv1, du2 and dv2 (as TreeNode does). `read(u, v)` returns what a probe at that place
/// reads, holes and places outside the picture included. A constant added to `range` and to all that `read` returns
/// changes nothing.
template <class Offsets, class Read>
constexpr int feature(int u, int v, OffsetScale scale, ProbeRange range, const Offsets& offsets, const Read& read) {
  const auto probe = [&](int du, int dv) -> int {
    const int mm = read(probe_place(u, du, scale.u), probe_place(v, dv, scale.v));
    return mm < range.low_mm ? range.low_mm : mm > range.high_mm ? range.high_mm : mm;
  };
  return probe(offsets.du1, offsets.dv1) - probe(offsets.du2, offsets.dv2);
}

}  // namespace vesalius
