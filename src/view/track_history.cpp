#include "view/track_history.h"

#include <limits>
#include <optional>
#include <utility>

namespace vesalius {
namespace {

constexpr std::size_t kMostKnown = 60;
constexpr double kBefore = -std::numeric_limits<double>::infinity();

}  // namespace

TrackHistory::TrackHistory(PeopleTracker first) { known_.push_back({kBefore, std::move(first)}); }

PeopleTracker& TrackHistory::before(double at_s) {
  std::optional<PeopleTracker> newest;
  bool again = false;  // whether this very frame was there
  while (known_.size() > 1 && known_.back().at_s >= at_s) {
    again = known_.back().at_s == at_s;
    if (!newest) newest = std::move(known_.back().tracker);
    known_.pop_back();
  }
  // What came before this frame is not known any more. The newest tracker takes that as the jump it is.
  if (known_.size() == 1 && newest && !again) known_.front().tracker = std::move(*newest);
  known_.push_back({at_s, known_.back().tracker});
  if (known_.size() > kMostKnown) known_.pop_front();
  return known_.back().tracker;
}

void TrackHistory::restart(const TrackOptions& options, const std::shared_ptr<const Appearance>& appearance,
                           const std::shared_ptr<const BodyFitter>& fitter) {
  PeopleTracker anew = known_.back().tracker.restarted(options, appearance, fitter);
  known_.clear();
  known_.push_back({kBefore, std::move(anew)});
}

}  // namespace vesalius
