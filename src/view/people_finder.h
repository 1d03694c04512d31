#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "vesalius/track_people.h"
#include "view/frame_message.h"
#include "view/player.h"
#include "view/track_history.h"

namespace vesalius {

/// Options, and the detector that has them.
struct FinderSettings {
  PeopleOptions options;
  Detector detector;
};

/// Finds the people in frames of a source in which one moves, and follows them if that is wanted.
class PeopleFinder {
 public:
  using Settings = std::shared_ptr<const FinderSettings>;

  /// Throws UsageError for an option outside its range.
  PeopleFinder(Settings settings, bool track);

  /// Returns a frame's people, with all that the page shows of them but the latency. If `settings` are not those of the
  /// frame before, people are followed anew where they have to be. With a trace if `with_stages`. Throws what the
  /// detector and the tracker throw.
  ViewedFrame find(const std::shared_ptr<const PlayedFrame>& played, const Settings& settings, bool with_stages);

 private:
  void take_over(const Settings& settings);
  std::vector<Person> detect(const Frame& frame, const AskPrior& ask, ViewedFrame& viewed) const;
  void follow(ViewedFrame& viewed);

  Settings settings_;
  std::optional<TrackHistory> tracks_;  ///< none if people are not followed
  int frames_ = 0;
};

}  // namespace vesalius
