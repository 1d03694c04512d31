#include "io/sources/timed_frames.h"

#include <fmt/format.h>

namespace vesalius {

TimedFrames::TimedFrames(const std::vector<std::int64_t>& times_us) {
  constexpr double kMicroseconds = 1e6;
  for (const std::int64_t time_us : times_us) {
    times_s_.push_back(static_cast<double>(time_us) / kMicroseconds);
    std::string name = fmt::format("{:.6f}", times_s_.back());
    // Another frame of the same time, and yet another.
    while (!names_.empty() && names_.back().starts_with(name)) name += "_again";
    names_.push_back(std::move(name));
  }
}

std::size_t TimedFrames::first_from(double time_s) const {
  const auto found = std::ranges::find_if(times_s_, [time_s](double one) { return !(one < time_s); });
  return static_cast<std::size_t>(found - times_s_.begin());
}

}  // namespace vesalius
