#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vesalius {

/// Bounds of 95 % confidence. NaN where nothing is known.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};

/// Wilson's score interval of a share (E. B. Wilson 1927). Throws Error unless 0 <= successes <= trials; no trials give
/// 0 to 1.
Interval wilson(double successes, double trials);

/// Resamples of a set, the same ones whatever is computed from them.
inline constexpr std::size_t kReplicates = 200;
using Weights = std::array<std::uint8_t, kReplicates>;

/// How often each resample holds the frame of this key: Poisson numbers of mean 1 (the Poisson bootstrap: no resample
/// needs to know how many frames will come). Depends on the key alone, so that two evaluations of the same frames
/// resample them alike and their difference has an interval of its own.
Weights bootstrap_weights(std::uint64_t frame_key);

/// Names a frame by set and name (64-bit FNV-1a).
std::uint64_t frame_key(const char* set, const char* frame);

/// From the 2.5th to the 97.5th percentile, interpolated; values that are not finite do not count. NaN for none.
Interval percentile_interval(std::vector<double> values);

}  // namespace vesalius
