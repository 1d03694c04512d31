#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/base/frame_source.h"

namespace vesalius {

/// When the frames of a file were taken, and their names, which are those times.
class TimedFrames {
 public:
  TimedFrames() = default;
  /// `times_us` are in microseconds, in the order of the frames; there must be one.
  explicit TimedFrames(const std::vector<std::int64_t>& times_us);

  std::size_t size() const { return times_s_.size(); }
  double time_s(std::size_t index) const { return times_s_[index]; }
  /// The time in seconds; frames of one time have different names.
  const std::string& name(std::size_t index) const { return names_[index]; }
  TimeSpan span() const { return {times_s_.front(), std::max(times_s_.front(), times_s_.back())}; }
  /// Returns the index of the first frame that is not before `time_s`, or size().
  std::size_t first_from(double time_s) const;

 private:
  std::vector<double> times_s_;
  std::vector<std::string> names_;
};

}  // namespace vesalius
