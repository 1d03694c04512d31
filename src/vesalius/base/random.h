#pragma once

#include <cmath>
#include <cstdint>

namespace vesalius {

/// A small seeded generator (PCG32, O'Neill 2014). It gives the same numbers on every platform, unlike the
/// distributions of the standard library. Seed it by (seed, stream), e.g. (run seed, image index), never by time.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : increment_((stream << 1U) | 1U) {
    next();
    state_ += seed;
    next();
  }

  /// Returns any 32-bit value, all equally likely.
  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
  }

  /// Returns a number from 0 to bound - 1, all equally likely; `bound` must be above 0.
  std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(next()) * bound) >> 32U);
  }

  /// Returns a number from [0, 1), or from [low, high), uniformly distributed.
  double uniform() { return next() * (1.0 / 4294967296.0); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// Returns a normally distributed number (Box-Muller).
  double normal(double mean = 0.0, double sigma = 1.0) {
    const double u1 = 1.0 - uniform();
    const double u2 = uniform();
    return mean + sigma * std::sqrt(-2.0 * std::log(u1)) * std::cos(6.283185307179586 * u2);
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
};

}  // namespace vesalius
