#pragma once

#include <cstdint>
#include <limits>

#include "vesalius/base/random.h"

namespace vesalius::synth {

/// The purpose of a stream of random numbers. Each purpose has a stream of its own, so that a change of one leaves the
/// others unchanged.
enum class Purpose : std::uint64_t { body, plan, scene, noise, colour_noise, cut_out, filter, matching };
inline constexpr std::uint64_t kPurposes = 8;

inline Random random_for(std::uint64_t seed, Purpose purpose, std::uint64_t index) {
  return Random(seed * kPurposes + static_cast<std::uint64_t>(purpose), index);
}

/// Returns the index of the streams of frame k of a clip, which no single frame has.
inline std::uint64_t clip_stream(std::uint64_t clip, std::uint32_t k) { return ((clip + 1) << 32U) | k; }

/// The place of k for what is the same in a whole clip; the numbers from here on are no frames.
inline constexpr std::uint32_t kWholeClip = 0xFFFFFF00U;

}  // namespace vesalius::synth
