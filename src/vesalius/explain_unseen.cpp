#include "vesalius/explain_unseen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "vesalius/derive_joints.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

// Chosen on rendered people; docs/tracking.md says how often the reasons are right.
constexpr float kPredictedReach_m = 0.12F;  // about a predicted place: what is predicted is that far off
constexpr float kGuessReach_m = 0.18F;      // about a guessed one
constexpr float kFlesh_m = 0.18F;   // by which the own body must be nearer: predicted places are a little too deep
constexpr float kNearer_m = 0.05F;  // by which others must be nearer
constexpr float kSeenPast = 0.25F;  // weight of where the camera sees past: there it cannot be
constexpr float kBeforeCamera_m = 0.05F;

bool is_blank_row(const DepthImage& depth, int v) {
  return std::all_of(depth.row(v), depth.row(v) + depth.width(), [](std::uint16_t mm) { return mm == 0; });
}

/// Where the parts and joints of a person would be, also those of which nobody is sure enough to give a place.
class Places {
 public:
  Places(const Person& person, const BodyModel& body) : person_(person) {
    const std::vector<SkeletonPart>& parts = person.skeleton.parts;
    const auto is_known = [](const SkeletonPart& part) { return part.state != State::none; };
    if (body.distribution.parts.empty() || std::ranges::all_of(parts, is_known)) return;
    const Skeleton drawn = drawn_to_votes(body.distribution, person.skeleton);
    const std::vector<PredictedPart> likely =
        predict_parts(body.distribution, given_centres(drawn), counted_votes(body.distribution, drawn));
    if (likely.empty()) return;
    guess_ = person.skeleton;
    for (std::size_t p = 0; p < likely.size(); ++p) {
      if (is_known(parts[p])) continue;
      guess_.parts[p].state = State::predicted;
      guess_.parts[p].centre = likely[p].centre;
    }
    guessed_joints_ = derive_joints(body, guess_);
  }

  Eigen::Vector3f part(std::size_t p) const {
    const SkeletonPart& part = person_.skeleton.parts[p];
    if (part.state != State::none) return part.centre;
    return guess_.parts.empty() ? unknown() : guess_.parts[p].centre;
  }
  Eigen::Vector3f joint(std::size_t set, std::size_t j) const {
    const Joint& joint = person_.joints[set][j];
    if (joint.state != State::none) return joint.position;
    return guessed_joints_.empty() ? unknown() : guessed_joints_[set][j].position;
  }

 private:
  static Eigen::Vector3f unknown() { return Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()); }

  const Person& person_;
  Skeleton guess_;
  std::vector<std::vector<Joint>> guessed_joints_;
};

/// Looks at a frame about places of joints and parts.
class UnseenSearch {
 public:
  UnseenSearch(const Frame& frame, std::vector<const Person*> people)
      : frame_(frame), people_(std::move(people)), picture_(picture_with_readings(frame.depth)) {}

  /// Explains a joint or part of person `own`, which would be at `place`. Pixels with the labels `parts` show it.
  template <class Point>
  void explain(std::size_t own, const Eigen::Vector3f& place, std::span<const int> parts, Point& point) {
    point.unseen = Unseen::none;
    point.behind = -1;
    if (point.state == State::observed) return;
    point.unseen = Unseen::not_sure;
    if (!place.allFinite()) return;
    own_ = own;
    z_m_ = place.z();
    parts_ = parts;
    if (z_m_ < kBeforeCamera_m) {
      point.unseen = Unseen::out_of_picture;
      return;
    }
    look_about(place, point.state == State::none ? kGuessReach_m : kPredictedReach_m);
    const auto most = static_cast<std::size_t>(std::ranges::max_element(votes_) - votes_.begin());
    point.unseen = most < kCauses.size() ? kCauses[most] : Unseen::behind_person;
    if (most >= kCauses.size()) point.behind = int(most - kCauses.size());
  }

 private:
  /// What is counted, before people. Of as many votes the first counts.
  static constexpr std::array kCauses{Unseen::not_sure, Unseen::out_of_picture, Unseen::no_depth,
                                      Unseen::behind_something};

  /// Counts the votes of places on a disk.
  void look_about(const Eigen::Vector3f& place, float reach_m) {
    constexpr int kRings = 3;
    constexpr float kFarthest_px = 1e6F;
    votes_.assign(kCauses.size() + people_.size(), 0.F);
    const Eigen::Vector2f centre = frame_.camera.pixel(place);
    const float step = reach_m / place.z() / float(kRings);
    const auto column = [&](float px) { return int(std::lround(std::clamp(px, -kFarthest_px, kFarthest_px))); };
    for (int row = -kRings; row <= kRings; ++row) {
      for (int col = -kRings; col <= kRings; ++col) {
        if (row * row + col * col > kRings * kRings + 1) continue;
        look_at(column(centre.x() + float(col) * step * frame_.camera.fx),
                column(centre.y() + float(row) * step * frame_.camera.fy));
      }
    }
  }

  void look_at(int u, int v) {
    const bool inside =
        u >= picture_.u && v >= picture_.v && u < picture_.u + picture_.width && v < picture_.v + picture_.height;
    if (!inside) return add(Unseen::out_of_picture);
    const float depth_m = float(frame_.depth(u, v)) * 1e-3F;
    if (depth_m == 0.F) return add(Unseen::no_depth);
    const std::size_t who = person_at(u, v);
    if (who == own_) {
      if (depth_m >= z_m_ - kFlesh_m || shows_it(u, v)) return add(Unseen::not_sure);
    } else if (depth_m >= z_m_ - kNearer_m) {
      return add(Unseen::not_sure, kSeenPast);
    }
    if (who == people_.size()) return add(Unseen::behind_something);
    votes_[kCauses.size() + who] += 1.F;
  }

  void add(Unseen cause, float weight = 1.F) {
    votes_[static_cast<std::size_t>(std::ranges::find(kCauses, cause) - kCauses.begin())] += weight;
  }

  bool shows_it(int u, int v) const {
    const LabelImage& labels = people_[own_]->labels;
    return labels.same_size(frame_.depth) && std::ranges::find(parts_, int(labels(u, v))) != parts_.end();
  }

  /// Returns whose pixel it is, the number of people for nobody's.
  std::size_t person_at(int u, int v) const {
    const auto has = [&](const Person* person) { return !person->mask.empty() && person->mask(u, v) != 0; };
    return static_cast<std::size_t>(std::ranges::find_if(people_, has) - people_.begin());
  }

  const Frame& frame_;
  const std::vector<const Person*> people_;
  const Box picture_;
  std::vector<float> votes_;  ///< of each of kCauses, then for each person

  // What is looked for.
  std::size_t own_ = 0;
  float z_m_ = 0.F;
  std::span<const int> parts_;
};

void explain_person(UnseenSearch& search, const BodyModel& body, std::size_t index, Person& person) {
  const Places places(person, body);
  for (std::size_t p = 0; p < person.skeleton.parts.size(); ++p) {
    const std::array own{int(p)};
    search.explain(index, places.part(p), own, person.skeleton.parts[p]);
  }
  for (std::size_t s = 0; s < person.joints.size(); ++s) {
    const std::vector<JointDefinition>& joints = body.joint_sets[s].joints;
    for (std::size_t j = 0; j < std::min(joints.size(), person.joints[s].size()); ++j) {
      search.explain(index, places.joint(s, j), joints[j].parts, person.joints[s][j]);
    }
  }
}

}  // namespace

Box picture_with_readings(const DepthImage& depth) {
  constexpr int kMostShare = 10;
  const int most_u = depth.width() / kMostShare, most_v = depth.height() / kMostShare;
  int top = 0, bottom = 0;
  while (top < most_v && is_blank_row(depth, top)) ++top;
  while (bottom < most_v && is_blank_row(depth, depth.height() - 1 - bottom)) ++bottom;
  // Row by row, as memory has the picture: how much of the sides is blank in all of them.
  int left = most_u, right = most_u;
  for (int v = 0; v < depth.height() && left + right > 0; ++v) {
    const std::uint16_t* row = depth.row(v);
    const std::uint16_t* end = row + depth.width();
    const auto has_reading = [](std::uint16_t mm) { return mm != 0; };
    left = int(std::find_if(row, row + left, has_reading) - row);
    right = int(std::find_if(std::reverse_iterator(end), std::reverse_iterator(end - right), has_reading) -
                std::reverse_iterator(end));
  }
  return {left, top, depth.width() - left - right, depth.height() - top - bottom};
}

void explain_unseen(const Frame& frame, const BodyModel& body, std::vector<Person>& people) {
  if (people.empty()) return;
  std::vector<const Person*> all;
  all.reserve(people.size());
  for (const Person& person : people) all.push_back(&person);
  UnseenSearch search(frame, std::move(all));
  for (std::size_t p = 0; p < people.size(); ++p) explain_person(search, body, p, people[p]);
}

void explain_unseen(const Frame& frame, const BodyModel& body, TrackedFrame& tracked) {
  if (tracked.people.empty()) return;
  std::vector<const Person*> all;
  all.reserve(tracked.people.size());
  for (const TrackedPerson& one : tracked.people) all.push_back(&one.person);
  UnseenSearch search(frame, std::move(all));
  for (std::size_t p = 0; p < tracked.people.size(); ++p) {
    TrackedPerson& one = tracked.people[p];
    explain_person(search, body, p, one.person);
    for (std::size_t s = 0; s < one.smoothed.size(); ++s) {
      for (std::size_t j = 0; j < one.smoothed[s].size(); ++j) {
        one.smoothed[s][j].unseen = one.person.joints[s][j].unseen;
        one.smoothed[s][j].behind = one.person.joints[s][j].behind;
      }
    }
  }
}

}  // namespace vesalius
