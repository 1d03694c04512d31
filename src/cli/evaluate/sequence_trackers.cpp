#include "cli/evaluate/sequence_trackers.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "vesalius/base/frame_source.h"

namespace vesalius::cli {
namespace {

constexpr double kLeastOverlap = 0.1;

/// Returns the IoU of two masks.
double overlap(const Mask& a, const Mask& b) {
  if (!a.same_size(b)) return 0.0;
  long both = 0, either = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] != 0 && b[i] != 0 ? 1 : 0;
    either += a[i] != 0 || b[i] != 0 ? 1 : 0;
  }
  return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 0.0;
}

Eigen::Vector3f middle_of(const Skeleton& skeleton) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float parts = 0.F;
  for (const SkeletonPart& part : skeleton.parts) {
    if (part.state != State::observed) continue;
    sum += part.centre;
    parts += 1.F;
  }
  return parts > 0.F ? Eigen::Vector3f(sum / parts) : sum;
}

/// STAND-IN for the PeopleTracker.
class OverlapTracker {
 public:
  explicit OverlapTracker(Detector detector) : detector_(std::move(detector)) {}

  TrackedFrame operator()(const Frame& frame) {
    TrackedFrame tracked;
    tracked.time_s = frame.time_s.value_or(static_cast<double>(frames_) / kUsualRate);
    ++frames_;
    for (Person& person : detector_.detect(frame)) {
      TrackedPerson& found = tracked.people.emplace_back();
      found.state = TrackState::tracked;
      found.position = middle_of(person.skeleton);
      found.person = std::move(person);
    }
    give_ids(tracked.people);
    last_.clear();
    for (const TrackedPerson& person : tracked.people) last_.emplace_back(person.id, person.person.mask);
    std::ranges::sort(tracked.people, {}, &TrackedPerson::id);
    return tracked;
  }

 private:
  /// The pair with the largest overlap first; whoever overlaps with nobody is new.
  void give_ids(std::vector<TrackedPerson>& people) {
    struct Pair {
      double overlap;
      std::size_t person, last;
    };
    std::vector<Pair> pairs;
    for (std::size_t p = 0; p < people.size(); ++p) {
      for (std::size_t l = 0; l < last_.size(); ++l) {
        const double share = overlap(people[p].person.mask, last_[l].second);
        if (share >= kLeastOverlap) pairs.push_back({share, p, l});
      }
    }
    std::ranges::stable_sort(pairs, std::ranges::greater{}, &Pair::overlap);
    std::vector<bool> taken(last_.size(), false);
    for (const Pair& pair : pairs) {
      if (people[pair.person].id != 0 || taken[pair.last]) continue;
      people[pair.person].id = last_[pair.last].first;
      taken[pair.last] = true;
    }
    for (TrackedPerson& person : people) {
      if (person.id == 0) person.id = ++ids_;
    }
  }

  Detector detector_;
  int frames_ = 0;
  int ids_ = 0;
  std::vector<std::pair<int, Mask>> last_;  ///< id and mask of the people of the frame before
};

}  // namespace

SequenceTrackerFactory sequence_trackers(std::shared_ptr<const PixelLabeller> labeller, const DetectOptions& options) {
  const Detector detector(std::move(labeller), options);
  return [detector] { return OverlapTracker(detector); };
}

}  // namespace vesalius::cli
