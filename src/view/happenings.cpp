#include "view/happenings.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace vesalius {
namespace {

constexpr std::size_t kMostEvents = 500;
constexpr std::size_t kMostStretches = 500;
/// So near are times at which two runs of frames tell of one thing: they know different frames.
constexpr double kSameTime_s = 1.0;

}  // namespace

void Stretches::add(Stretch stretch) {
  const auto apart = [&](const Stretch& other) { return other.second < stretch.first || other.first > stretch.second; };
  for (const Stretch& other : list_) {
    if (!apart(other)) stretch = {std::min(stretch.first, other.first), std::max(stretch.second, other.second)};
  }
  std::erase_if(list_, [&](const Stretch& other) { return !apart(other); });
  list_.insert(std::ranges::upper_bound(list_, stretch), stretch);
  if (list_.size() <= kMostStretches) return;
  std::size_t nearest = 0;
  const auto gap = [&](std::size_t i) { return list_[i + 1].first - list_[i].second; };
  for (std::size_t i = 1; i + 1 < list_.size(); ++i) nearest = gap(i) < gap(nearest) ? i : nearest;
  list_[nearest].second = list_[nearest + 1].second;
  list_.erase(list_.begin() + static_cast<std::ptrdiff_t>(nearest) + 1);
}

void Stretches::remove(Stretch stretch) {
  if (stretch.first == stretch.second) return;
  std::vector<Stretch> left;
  for (const Stretch& other : list_) {
    if (other.second <= stretch.first || other.first >= stretch.second) {
      left.push_back(other);
      continue;
    }
    if (other.first < stretch.first) left.emplace_back(other.first, stretch.first);
    if (other.second > stretch.second) left.emplace_back(stretch.second, other.second);
  }
  list_ = std::move(left);
}

void Happenings::add(double at_s, const TrackedFrame& frame, double track_rate, double gap_s) {
  if (last_s_ && at_s == *last_s_) return;  // the same once more
  const bool begins = !last_s_ || at_s < *last_s_ || (at_s - *last_s_) * track_rate > gap_s;
  const Stretches::Stretch since{begins ? at_s : *last_s_, at_s};
  last_s_ = at_s;
  known_.add(since);
  const bool anybody = std::ranges::any_of(
      frame.people, [](const TrackedPerson& p) { return is_found(p) && p.state != TrackState::fresh; });
  anybody ? seen_.add(since) : seen_.remove(since);
  if (!frame.followed) return;
  if (begins) {
    people_.clear();
    ++run_;
  }
  const auto place = [&](double track_s) { return at_s + (track_s - frame.time_s) / track_rate; };
  see_off(frame.people);
  for (const TrackedPerson& person : frame.people) {
    if (person.state != TrackState::lost) follow(at_s, person, place(person.seen_s), begins);
  }
  for (const StanceEvent& event : frame.events) {
    tell({place(event.time_s), event.id, to_string(event.stance), people_[event.id].stance, run_});
  }
  for (const TrackedPerson& person : frame.people) {
    if (const auto known = people_.find(person.id); known != people_.end()) known->second.stance = person.stance;
  }
}

void Happenings::see_off(const std::vector<TrackedPerson>& people) {
  std::erase_if(people_, [&](const auto& one) {
    const auto& [id, known] = one;
    const auto now = std::ranges::find(people, id, &TrackedPerson::id);
    if (now != people.end() && now->state != TrackState::lost) return false;
    if (known.sure) tell({known.seen_s, id, "went", known.stance, run_});
    return true;
  });
}

void Happenings::follow(double at_s, const TrackedPerson& person, double seen_s, bool begins) {
  Known& known = people_.try_emplace(person.id, Known{at_s, seen_s, begins}).first->second;
  known.seen_s = seen_s;
  known.sure |= person.state != TrackState::fresh;
  if (known.sure && !std::exchange(known.told, true)) tell({known.first_s, person.id, "came", {}, run_});
}

void Happenings::tell(Happening happening) {
  Happening* same = nullptr;
  const auto far = [&](const Happening& told) {
    return std::pair(told.id != happening.id, std::abs(told.at_s - happening.at_s));
  };
  for (Happening& told : events_) {
    if (told.run == run_ || told.what != happening.what || std::abs(told.at_s - happening.at_s) > kSameTime_s) continue;
    if (same == nullptr || far(told) < far(*same)) same = &told;
  }
  if (same != nullptr) {
    if (happening.before == Stance::unknown) happening.before = same->before;
    events_.erase(events_.begin() + (same - events_.data()));
  }
  events_.insert(std::ranges::upper_bound(events_, happening.at_s, {}, &Happening::at_s), happening);
  if (events_.size() > kMostEvents) events_.erase(events_.begin());
}

}  // namespace vesalius
