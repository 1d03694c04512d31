#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vesalius {

/// The bounds of 95 % confidence; NaN if nothing is known.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};

/// Returns Wilson's score interval of a share (E. B. Wilson 1927). Without trials it is 0 to 1. Throws Error for
/// negative numbers or more successes than trials.
Interval wilson(double successes, double trials);

/// The number of resamples of a set. All computations use the same resamples.
inline constexpr std::size_t kReplicates = 200;
using Weights = std::array<std::uint8_t, kReplicates>;

/// Returns how often each resample contains the frame of this key: Poisson numbers of mean 1 (the Poisson bootstrap,
/// which need not know the number of frames in advance). They depend only on the key, so two evaluations of the same
/// frames are resampled alike and their difference has an interval of its own.
Weights bootstrap_weights(std::uint64_t frame_key);

/// Returns a key for a frame from the names of its set and its own (64-bit FNV-1a).
std::uint64_t frame_key(const char* set, const char* frame);

/// Returns the range from the 2.5th to the 97.5th percentile, interpolated. Values that are not finite do not count;
/// NaN for none.
Interval percentile_interval(std::vector<double> values);

/// Returns the middle value, or the upper of the two middle ones; 0 for no values.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace vesalius
