#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "export/people_record.h"
#include "vesalius/body_model.h"
#include "view/frame_message.h"

namespace vesalius {

/// Somebody of whom a PeopleLog knows.
struct LoggedPerson {
  int id = 0;
  std::size_t frames = 0;  ///< in which the person is
  std::size_t bodies = 0;  ///< in which the person has a fitted body
};

/// The people who were found since a source was opened, for files of other programs: as exact as lines of JSON are, in
/// a twentieth of their bytes. Any thread may use it.
class PeopleLog {
 public:
  static constexpr std::size_t kUsualBytes = 64U << 20U;  ///< some 25 minutes of one person, 30 frames a second

  /// Joints are those of the set that tables have usually, or of the first where a body has others. Frames without
  /// times get those of `rate` frames a second. Where more than `most_bytes` would be kept, the frames that were added
  /// first are forgotten.
  PeopleLog(const BodyModel& body, double rate, std::size_t most_bytes = kUsualBytes);

  /// Adds a frame, unless its time is there already: a source counts once, however it was moved in. With other options
  /// than before (any number that tells them apart) it takes the place of what was found with those.
  void add(const ViewedFrame& viewed, int options);

  std::vector<LoggedPerson> people() const;  ///< by id
  std::size_t frames() const;                ///< that are kept
  std::size_t forgotten() const;             ///< frames that gave way to newer ones
  std::size_t most_bytes() const { return most_bytes_; }

  /// Returns the people with their joints, or with their fitted bodies instead: files have one or the other.
  PeopleRecord record(bool bodies) const;

 private:
  struct LoggedFrame;
  using FramePointer = std::shared_ptr<const LoggedFrame>;

  std::vector<FramePointer> in_order() const;

  const std::size_t set_index_;
  const std::string set_;
  const std::vector<std::string> joints_;
  const double rate_;
  const std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::map<double, FramePointer> frames_;  ///< by their places in the source
  std::deque<double> order_;               ///< those places, the one that was added first in front
  std::size_t bytes_ = 0;
  std::size_t forgotten_ = 0;
};

}  // namespace vesalius
