#pragma once

#include <cstdint>

namespace vesalius {

/// The highest rate of clips, frames a second.
inline constexpr double kHighestRate_hz = 1000.0;

/// How frames form clips, which come one after the other and are equally long.
struct ClipLayout {
  std::uint32_t frames_per_clip = 0;  ///< 0: frames stand alone
  double rate_hz = 0.0;               ///< frames a second, up to kHighestRate_hz; 0 if frames stand alone

  /// Returns the number of the clip to which a frame belongs, or -1 if it stands alone.
  int clip_of(std::uint64_t index) const { return frames_per_clip == 0 ? -1 : int(index / frames_per_clip); }
  friend bool operator==(const ClipLayout&, const ClipLayout&) = default;
};

/// Throws UsageError unless both numbers are 0 or both are in their range.
void check(const ClipLayout& clips);

}  // namespace vesalius
