#include "vesalius/merge/merge_people.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "vesalius/error.h"
#include "vesalius/merge/carry_people.h"
#include "vesalius/merge/fuse_person.h"
#include "vesalius/track/match_tracks.h"
#include "vesalius/track/track_motion.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr float kSigma_m = 0.15F;    // of the middle of somebody, as different cameras see it
constexpr float kMostCost = 8.F;     // at which somebody in one camera is the one in another
constexpr float kKnownIs = 3.F;      // that the id of a camera counts for the one who had it, and against others
constexpr float kTogether_m = 0.4F;  // two who are one all the time
constexpr double kTogether_s = 0.5;
constexpr double kSeenLately_s = 1.0;    // after being seen; later only an id tells who it is
constexpr std::size_t kRemembered = 64;  // of those who left

/// Somebody whom a camera sees, in the first camera's frame.
struct CameraSighting {
  int camera = 0;
  TrackedPerson person;
  Vector3f middle;
};

/// Returns the middle of somebody: the mean of all joints, which does not depend on the side that is seen as the
/// trunk's place does. Without joints that place.
Vector3f middle_of(const TrackedPerson& person) {
  Vector3f sum = Vector3f::Zero();
  int count = 0;
  if (!person.person.joints.empty()) {
    for (const Joint& joint : person.person.joints.front()) {
      if (joint.state == State::none) continue;
      sum += joint.position;
      ++count;
    }
  }
  return count == 0 ? person.position : Vector3f(sum / float(count));
}

int seen_parts(const TrackedPerson& person) {
  return int(std::ranges::count(person.person.skeleton.parts, State::observed, &SkeletonPart::state));
}

/// Somebody of the one list.
struct MergedPerson {
  int id = 0;
  TrackMotion motion;
  double since_s = 0.0, seen_s = 0.0;
  int stance_camera = -1;
  Stance stance = Stance::unknown;
  std::vector<const CameraSighting*> found, unseen;  ///< of this moment; unseen ones are hidden to their cameras
  TrackedPerson last;                                ///< as told last

  explicit MergedPerson(const Vector3f& middle) : motion(middle, kSigma_m) {}
  bool is_found() const { return !found.empty(); }
  bool is_found_by(int camera) const {
    return std::ranges::any_of(found, [&](const CameraSighting* s) { return s->camera == camera; });
  }
  Vector3f found_middle() const {
    Vector3f sum = Vector3f::Zero();
    for (const CameraSighting* sighting : found) sum += sighting->middle;
    return sum / float(found.size());
  }
};

}  // namespace

struct PeopleMerger::State {
  std::vector<CameraSighting> carry_all(std::vector<CameraPeople> seen, TrackedFrame& out) const;
  float cost(const MergedPerson& person, const CameraSighting& sighting) const;
  void assign(int camera, const std::vector<CameraSighting>& sightings);
  void give_hidden(const std::vector<CameraSighting>& sightings);
  void join_those_who_are_one();
  void join(MergedPerson& stays, MergedPerson& goes);
  MergedPerson* find(int id);
  TrackedPerson describe(MergedPerson& person) const;

  std::vector<Eigen::Isometry3f> first_from;
  int last_id = 0;
  double now_s = 0.0;  ///< time of the moment
  bool begun = false;
  std::vector<MergedPerson> people;                        ///< by id
  std::vector<MergedPerson> left;                          ///< the last one comes last
  std::map<std::pair<int, int>, int> known;                ///< camera and its id: whose that is
  std::map<std::pair<int, int>, double> together_since_s;  ///< two ids: since when they are at one place
};

std::vector<CameraSighting> PeopleMerger::State::carry_all(std::vector<CameraPeople> seen, TrackedFrame& out) const {
  std::vector<CameraSighting> sightings;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    TrackedFrame& told = seen[c].people;
    if (c == 0) out.time_s = told.time_s;
    if (told.floor && !out.floor) out.floor = carried(*told.floor, first_from[c]);
    for (TrackedPerson& person : told.people) {
      if (person.state == TrackState::lost) continue;
      carry(person, first_from[c], float(seen[c].behind_s));
      const Vector3f middle = middle_of(person);
      sightings.push_back({int(c), std::move(person), middle});
    }
  }
  return sightings;
}

/// Returns what it costs that a sighting is somebody. Others count who were seen, in this moment by an earlier camera
/// or a short while ago.
float PeopleMerger::State::cost(const MergedPerson& person, const CameraSighting& sighting) const {
  const auto whose = known.find({sighting.camera, sighting.person.id});
  const bool is_known = whose != known.end(), is_this = is_known && whose->second == person.id;
  const bool is_recent = now_s - person.seen_s <= kSeenLately_s;
  // Whom no other camera sees is whoever has the id again, wherever that is, but for somebody who fits better.
  if (!person.is_found() && !is_recent) return is_this ? -kKnownIs : std::numeric_limits<float>::infinity();
  const Vector3f at = person.is_found() ? person.found_middle() : person.motion.position();
  const float far = (sighting.middle - at).squaredNorm() / (2.F * kSigma_m * kSigma_m);
  if (is_this) return (person.is_found() ? far : std::min(far, kMostCost)) - kKnownIs;
  return is_known ? far + kKnownIs : far;
}

/// Gives the people whom a camera found to those of the list, and begins new ones.
void PeopleMerger::State::assign(int camera, const std::vector<CameraSighting>& sightings) {
  std::vector<const CameraSighting*> found;
  for (const CameraSighting& sighting : sightings) {
    if (sighting.camera == camera && vesalius::is_found(sighting.person)) found.push_back(&sighting);
  }
  Eigen::MatrixXf costs(static_cast<Eigen::Index>(people.size()), static_cast<Eigen::Index>(found.size()));
  for (std::size_t p = 0; p < people.size(); ++p) {
    for (std::size_t f = 0; f < found.size(); ++f) {
      costs(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(f)) = cost(people[p], *found[f]);
    }
  }
  const std::vector<int> match = match_tracks(costs, kMostCost);
  std::vector<bool> taken(found.size(), false);
  for (std::size_t p = 0; p < people.size(); ++p) {
    if (match[p] < 0) continue;
    const auto f = static_cast<std::size_t>(match[p]);
    taken[f] = true;
    people[p].found.push_back(found[f]);
    if (found[f]->person.state == TrackState::tracked) known[{camera, found[f]->person.id}] = people[p].id;
  }
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (taken[f] || found[f]->person.state != TrackState::tracked) continue;  // ids are not for guesses
    const auto whose = known.find({camera, found[f]->person.id});
    const auto back = std::ranges::find_if(
        left, [&](const MergedPerson& person) { return whose != known.end() && person.id == whose->second; });
    if (back != left.end()) {
      people.push_back(std::move(*back));
      left.erase(back);
      people.back().motion = TrackMotion(found[f]->middle, kSigma_m);
    } else {
      people.emplace_back(found[f]->middle);
      people.back().id = ++last_id;
      people.back().since_s = now_s;
      known[{camera, found[f]->person.id}] = last_id;
    }
    people.back().found.push_back(found[f]);
  }
}

void PeopleMerger::State::give_hidden(const std::vector<CameraSighting>& sightings) {
  for (const CameraSighting& sighting : sightings) {
    if (sighting.person.state != TrackState::hidden) continue;
    const auto whose = known.find({sighting.camera, sighting.person.id});
    if (whose == known.end()) continue;
    if (MergedPerson* person = find(whose->second)) {
      if (!person->is_found_by(sighting.camera)) person->unseen.push_back(&sighting);
    }
  }
}

MergedPerson* PeopleMerger::State::find(int id) {
  const auto person = std::ranges::find(people, id, &MergedPerson::id);
  return person == people.end() ? nullptr : &*person;
}

void PeopleMerger::State::join(MergedPerson& stays, MergedPerson& goes) {
  for (auto& [seen, id] : known) {
    if (id == goes.id) id = stays.id;
  }
  stays.found.insert(stays.found.end(), goes.found.begin(), goes.found.end());
  stays.unseen.insert(stays.unseen.end(), goes.unseen.begin(), goes.unseen.end());
  stays.since_s = std::min(stays.since_s, goes.since_s);
}

/// Whoever began as two, since cameras did not agree at first, becomes one.
void PeopleMerger::State::join_those_who_are_one() {
  std::set<int> gone;
  std::map<std::pair<int, int>, double> together;
  for (std::size_t a = 0; a < people.size(); ++a) {
    for (std::size_t b = a + 1; b < people.size(); ++b) {
      MergedPerson &one = people[a], &other = people[b];
      if (!one.is_found() || !other.is_found() || gone.contains(one.id) || gone.contains(other.id)) continue;
      const bool share =
          std::ranges::any_of(one.found, [&](const CameraSighting* s) { return other.is_found_by(s->camera); });
      if (share || (one.found_middle() - other.found_middle()).norm() > kTogether_m) continue;
      const auto before = together_since_s.find({one.id, other.id});
      const double since_s = before == together_since_s.end() ? now_s : before->second;
      if (now_s - since_s < kTogether_s) {
        together[{one.id, other.id}] = since_s;
        continue;
      }
      join(one, other);
      gone.insert(other.id);
    }
  }
  std::erase_if(people, [&](const MergedPerson& person) { return gone.contains(person.id); });
  together_since_s = std::move(together);
}

TrackedPerson PeopleMerger::State::describe(MergedPerson& person) const {
  std::vector<const CameraSighting*> seen = person.is_found() ? person.found : person.unseen;
  // The first stands for all that is one camera's: body, stance and score.
  std::ranges::stable_sort(seen, {}, [&](const CameraSighting* s) { return s->camera != person.stance_camera; });
  const bool other_is_better = std::ranges::any_of(
      seen, [&](const CameraSighting* s) { return seen_parts(s->person) > 2 * seen_parts(seen[0]->person); });
  if (seen.front()->camera != person.stance_camera || other_is_better) {
    std::ranges::stable_sort(seen, std::ranges::greater(),
                             [](const CameraSighting* s) { return seen_parts(s->person); });
    person.stance_camera = seen.front()->camera;
  }
  std::vector<const TrackedPerson*> members;
  members.reserve(seen.size());
  for (const CameraSighting* sighting : seen) members.push_back(&sighting->person);
  TrackedPerson told = fuse_person(members);
  told.id = person.id;
  told.state = person.is_found() ? TrackState::tracked : TrackState::hidden;
  told.position = Vector3f::Zero();
  for (const TrackedPerson* member : members) told.position += member->position / float(members.size());
  told.leaving = std::ranges::all_of(members, &TrackedPerson::leaving);
  told.since_s = person.since_s;
  if (person.is_found()) person.seen_s = now_s;
  told.seen_s = person.seen_s;
  const auto of_first = std::ranges::find(seen, 0, &CameraSighting::camera);
  const Person* in_picture = of_first == seen.end() ? nullptr : &(*of_first)->person.person;
  Person& picture = told.person;
  picture.mask = in_picture != nullptr ? in_picture->mask : Mask();
  picture.labels = in_picture != nullptr ? in_picture->labels : LabelImage();
  picture.box = in_picture != nullptr ? in_picture->box : Box();
  picture.yaw = in_picture != nullptr ? in_picture->yaw : std::nullopt;
  picture.points = in_picture != nullptr ? in_picture->points : std::vector<PersonPoint>();
  for (const TrackedPerson* member : members) picture.score = std::max(picture.score, member->person.score);
  std::vector<const CameraSighting*> all = person.found;
  all.insert(all.end(), person.unseen.begin(), person.unseen.end());
  std::ranges::stable_sort(all, {}, &CameraSighting::camera);
  for (const CameraSighting* s : all) told.seen_by.push_back({s->camera, s->person.id, s->person.state});
  return told;
}

PeopleMerger::PeopleMerger(std::vector<Eigen::Isometry3f> first_from) : state_(std::make_unique<State>()) {
  state_->first_from = std::move(first_from);
}

PeopleMerger::~PeopleMerger() = default;
PeopleMerger::PeopleMerger(PeopleMerger&&) noexcept = default;
PeopleMerger& PeopleMerger::operator=(PeopleMerger&&) noexcept = default;

TrackedFrame PeopleMerger::merge(std::vector<CameraPeople> seen) {
  State& s = *state_;
  const auto cameras = seen.size();
  if (cameras != s.first_from.size()) throw Error("merge: people of another number of cameras than there are poses");
  TrackedFrame out;
  const std::vector<CameraSighting> sightings = s.carry_all(std::move(seen), out);
  const double passed_s = s.begun ? std::max(0.0, out.time_s - s.now_s) : 0.0;
  s.begun = true;
  s.now_s = out.time_s;
  for (MergedPerson& person : s.people) {
    person.motion.predict(passed_s);
    person.found.clear();
    person.unseen.clear();
  }
  for (std::size_t c = 0; c < cameras; ++c) s.assign(int(c), sightings);
  s.give_hidden(sightings);
  s.join_those_who_are_one();
  std::vector<MergedPerson> staying;
  for (MergedPerson& person : s.people) {
    if (person.found.empty() && person.unseen.empty()) {
      person.last.state = TrackState::lost;
      person.last.seen_by.clear();
      out.people.push_back(person.last);
      s.left.push_back(std::move(person));
      continue;
    }
    if (person.is_found()) person.motion.update(person.found_middle(), kSigma_m);
    TrackedPerson told = s.describe(person);
    if (told.stance != person.stance) out.events.push_back({person.id, out.time_s, told.stance, person.stance});
    person.stance = told.stance;
    person.last = told;
    person.last.person.mask = {};
    person.last.person.labels = {};
    person.last.person.box = {};
    out.people.push_back(std::move(told));
    staying.push_back(std::move(person));
  }
  s.people = std::move(staying);
  if (s.left.size() > kRemembered) s.left.erase(s.left.begin(), s.left.end() - kRemembered);
  std::ranges::sort(out.people, {}, &TrackedPerson::id);
  std::ranges::sort(s.people, {}, &MergedPerson::id);
  return out;
}

}  // namespace vesalius
