#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
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

/// A source of such frames: what all have in common. `next` gives frame number `next_`.
class TimedSource : public FrameSource {
 public:
  int size() const override { return static_cast<int>(frames_.size()); }
  std::optional<TimeSpan> span() const override { return frames_.span(); }
  void seek(double time_s) override { next_ = frames_.first_from(time_s); }
  std::vector<std::string> notes() const override { return notes_; }

 protected:
  /// Returns frame `index` without its pictures.
  Frame frame_at(std::size_t index) const {
    Frame frame;
    frame.name = frames_.name(index);
    frame.time_s = frames_.time_s(index);
    frame.camera = camera_;
    return frame;
  }

  TimedFrames frames_;
  Camera camera_;
  std::vector<std::string> notes_;
  std::size_t next_ = 0;
};

}  // namespace vesalius
