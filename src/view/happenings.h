#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/person.h"

namespace vesalius {

/// Stretches of time, in order and apart from each other.
class Stretches {
 public:
  using Stretch = std::pair<double, double>;  ///< from, to

  /// Adds a stretch; what it touches becomes one with it. Of too many, the two with the least between them do.
  void add(Stretch stretch);
  /// Takes out what lies within a stretch.
  void remove(Stretch stretch);
  const std::vector<Stretch>& list() const { return list_; }

 private:
  std::vector<Stretch> list_;
};

/// What happened to somebody.
struct Happening {
  double at_s = 0.0;  ///< place in the source
  int id = 0;
  std::string what;                 ///< came, went, or the stance that began
  Stance before = Stance::unknown;  ///< the stance that ended
  int run = 0;                      ///< of frames that were shown one after the other; the last one that told of it
};

/// What happened in a source in which one moves, and where people are: all that is known so far. Frames may be shown in
/// any order. What was seen is not forgotten when it is seen again, since less may be known then: after a jump nobody
/// knows who has just come. What a run of frames tells replaces what one before it told of about the same time.
class Happenings {
 public:
  /// Adds a frame that was shown at a place of the source. `track_rate` is how many of the tracker's seconds one of the
  /// source has; a step of more than `gap_s` of them is a jump, and so is one back.
  void add(double at_s, const TrackedFrame& frame, double track_rate, double gap_s);

  const std::vector<Happening>& events() const { return events_; }  ///< in order of time; the last 500 at most
  const Stretches& seen() const { return seen_; }                   ///< where somebody is in view
  const Stretches& known() const { return known_; }                 ///< where frames were shown

 private:
  /// Somebody in the run.
  struct Known {
    double first_s = 0.0;  ///< place of the first frame
    double seen_s = 0.0;   ///< place of the last frame in which the person was found
    bool told = false;     ///< whether the person was there when the run began, or it is told that the person came
    bool sure = false;     ///< whether the person was no guess in some frame
    Stance stance = Stance::unknown;
  };

  void follow(double at_s, const TrackedPerson& person, double seen_s, bool begins);
  void see_off(const std::vector<TrackedPerson>& people);
  void tell(Happening happening);

  Stretches seen_, known_;
  std::vector<Happening> events_;
  std::map<int, Known> people_;  ///< by id
  std::optional<double> last_s_;
  int run_ = 0;
};

}  // namespace vesalius
