#include "vesalius/track/track_people.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"
#include "vesalius/track/match_cost.h"
#include "vesalius/track/match_tracks.h"
#include "vesalius/track/track.h"

namespace vesalius {
namespace {

constexpr std::size_t kMostTracks = 128;   // at once: no camera sees so many
constexpr std::size_t kMostExpected = 16;  // of whom the detector is told, the surest ones
constexpr double kExpect_s = 1.0;          // after being seen; later nobody knows the place
constexpr float kClearlyBetter = 0.1F;     // by which another lost person must look more different
constexpr float kFadePerS = 1.F;           // of the confidence of what is predicted of hidden people, per second

// The score of each frame counts as evidence; as much alike frames of one second as kFramesASecond independent ones.
constexpr float kFramesASecond = 5.F;
constexpr double kMostEvidence_s = 0.2;  // time for which one frame speaks
constexpr float kMostLogit = 4.F;
constexpr float kClearScore = 0.8F;  // that the frames in which somebody new is found have on average, at least

float logit(float p) { return std::clamp(std::log(p / (1.F - p)), -kMostLogit, kMostLogit); }

/// What there is to say of a step in time.
struct Step {
  double time_s = 0.0;
  double passed_s = 0.0;
  bool jump = false;  ///< the frame does not go on from the one before
};

/// Tells times of frames, of which some may have none, or nonsense.
class Times {
 public:
  Step next(const Frame& frame, const TrackOptions& options) const {
    const double period_s = 1.0 / static_cast<double>(options.rate);
    const bool known = frame.time_s && std::isfinite(*frame.time_s);
    if (frames_ == 0) return {known ? *frame.time_s : 0.0, 0.0, false};
    const double time_s = known ? *frame.time_s : first_s_ + static_cast<double>(frames_) * period_s;
    const double unknown_s = known_ ? last_s_ + period_s : time_s;  // where frames with and without times are mixed
    const double now_s = known ? time_s : unknown_s;
    const double passed_s = now_s - last_s_;
    const bool jump = !(passed_s >= 0.0) || passed_s > static_cast<double>(options.gap_s);
    return {now_s, jump ? 0.0 : passed_s, jump};
  }
  void take(const Frame& frame, const Step& step) {
    if (frames_ == 0) first_s_ = step.time_s;
    known_ = known_ || (frame.time_s && std::isfinite(*frame.time_s));
    last_s_ = step.time_s;
    ++frames_;
  }

 private:
  long frames_ = 0;
  bool known_ = false;  ///< whether a frame had a time
  double first_s_ = 0.0, last_s_ = 0.0;
};

/// People are taken in an order of their own, so that ids do not depend on the list's.
bool comes_before(const Sighting& a, const Sighting& b) {
  const auto key = [](const Sighting& s) {
    const Eigen::Vector3f& at = s.trunk.position;
    return std::make_tuple(-s.person.score, at.x(), at.y(), at.z(), s.person.box.u, s.person.box.v);
  };
  return key(a) < key(b);
}

void check(const Person& person, const BodyModel& body) {
  const bool fits = person.skeleton.parts.size() == body.parts.size() && person.joints.size() == body.joint_sets.size();
  if (!fits) {
    throw Error("track: a person has " + std::to_string(person.skeleton.parts.size()) + " parts and " +
                std::to_string(person.joints.size()) + " joint sets, expected the body's " +
                std::to_string(body.parts.size()) + " and " + std::to_string(body.joint_sets.size()));
  }
}

/// Moves what was found of somebody as the prediction moved.
void move(Person& person, const Eigen::Vector3f& by, float faded) {
  for (SkeletonPart& part : person.skeleton.parts) {
    if (part.state == State::none) continue;
    part.state = State::predicted;
    part.cluster = -1;
    part.centre += by;
    part.confidence *= faded;
  }
  person.skeleton.found = 0;
  for (std::vector<Joint>& joints : person.joints) {
    for (Joint& joint : joints) {
      if (joint.state == State::none) continue;
      joint.state = State::predicted;
      joint.position += by;
      joint.confidence *= faded;
    }
  }
  person.box = {};
}

void move(FittedBody& body, const Eigen::Vector3f& by, float faded, float sigma_m) {
  for (FittedBone& bone : body.bones) {
    if (bone.state == State::none) continue;
    bone.state = State::predicted;
    bone.head += by;
    bone.tail += by;
    bone.confidence *= faded;
    bone.covariance += sigma_m * sigma_m * Eigen::Matrix3f::Identity();
  }
}

}  // namespace

void visit_options(const std::string& prefix, TrackOptions& o, OptionVisitor& visitor) {
  visitor.option(prefix + "rate", o.rate, {"1/s", 0.01, 10000.0, "Frames a second of a source without times."});
  visitor.option(prefix + "confirm", o.confirm, {"", 1, 1000, "Frames in which somebody is found before being sure."});
  visitor.option(prefix + "confirm-within", o.confirm_s,
                 {"s", 0.0, 60.0, "Time from one of these to the next at most."});
  visitor.option(prefix + "hidden", o.hidden_s, {"s", 0.0, 3600.0, "Time after which somebody not found is lost."});
  visitor.option(prefix + "gap", o.gap_s, {"s", 0.0, 3600.0, "A longer step in time loses everybody."});
  visitor.option(prefix + "remembered", o.remembered, {"", 0, 10000, "Most lost people who are known again."});
  visitor.option(prefix + "same-look", o.same_look, {"", 0.0, 10.0, "Most difference of looks of one who comes back."});
  visitor.option(prefix + "odds", o.odds, {"", 1.0, 1000.0, "Most by which known people's odds are multiplied."});
}

struct PeopleTracker::State {
  const BodyModel* body;
  TrackOptions options;
  std::shared_ptr<const Appearance> appearance;
  FitBody fit_body;
  Times times;
  int last_id = 0;
  std::vector<Track> tracks;  ///< by id
  std::deque<Track> lost;     ///< the last one lost comes last

  Sighting look_at(const Frame& frame, Person person, const TrunkPlace& trunk) const {
    Sighting sighting{std::move(person), trunk, {}, body_scale(sighting.person.skeleton, *body), {}};
    const Person& found = sighting.person;
    if (!found.mask.same_size(frame.depth) || found.box.width <= 0) return sighting;
    sighting.look = look_of(frame, found.mask, found.box, appearance.get());
    sighting.place = TrackPlace(frame, found.mask, found.box);
    return sighting;
  }

  std::vector<Sighting> look_at_all(const Frame& frame, std::vector<Person> people) const {
    std::vector<std::optional<Sighting>> seen(people.size());
    parallel_for(static_cast<int>(people.size()), [&](int i) {
      Person& person = people[i];
      check(person, *body);
      if (!person.mask.same_size(frame.depth)) person.mask = {}, person.labels = {};
      person.box = bounding_box(person.mask);
      const std::optional<TrunkPlace> trunk = trunk_place(person, frame, *body);
      if (trunk) seen[i] = look_at(frame, std::move(person), *trunk);
    });
    std::vector<Sighting> sightings;
    for (std::optional<Sighting>& sighting : seen) {
      if (sighting) sightings.push_back(std::move(*sighting));
    }
    std::ranges::stable_sort(sightings, comes_before);
    return sightings;
  }

  /// Returns for each sighting the index of its track, or -1.
  std::vector<int> match(const std::vector<Sighting>& sightings, double time_s) const {
    Eigen::MatrixXf costs(static_cast<Eigen::Index>(tracks.size()), static_cast<Eigen::Index>(sightings.size()));
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      for (std::size_t s = 0; s < sightings.size(); ++s) {
        costs(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(s)) =
            match_cost(tracks[t], sightings[s], appearance.get(), time_s, options.same_look);
      }
    }
    std::vector<int> track_of(sightings.size(), -1);
    const std::vector<int> matched = match_tracks(costs, kMostMatchCost);
    for (std::size_t t = 0; t < matched.size(); ++t) {
      if (matched[t] >= 0) track_of[static_cast<std::size_t>(matched[t])] = static_cast<int>(t);
    }
    return track_of;
  }

  /// Returns the index of the lost person who is clearly this one, or -1.
  int who_came_back(const Sighting& sighting, double time_s) const {
    int best = -1;
    float least = 0.F, second = 0.F;
    bool rival = false;
    for (std::size_t i = 0; i < lost.size(); ++i) {
      // Others are rivals even where they look a little too different themselves.
      const std::optional<float> cost =
          return_cost(lost[i], sighting, appearance.get(), time_s, options.same_look + kClearlyBetter);
      if (!cost) continue;
      if (best < 0 || *cost < least) {
        if (best >= 0) second = least, rival = true;
        best = static_cast<int>(i);
        least = *cost;
      } else if (!rival || *cost < second) {
        second = *cost;
        rival = true;
      }
    }
    const bool clear = best >= 0 && least <= options.same_look && (!rival || second - least >= kClearlyBetter);
    return clear ? best : -1;
  }

  /// Begins a track, under the old id if somebody clearly came back.
  Track& begin(const Sighting& sighting, double time_s) {
    const int back = who_came_back(sighting, time_s);
    if (back < 0) {
      tracks.emplace_back(++last_id, sighting, time_s);
    } else {
      Track track(lost[static_cast<std::size_t>(back)].id, sighting, time_s);
      Track& known = lost[static_cast<std::size_t>(back)];
      track.look = known.look;
      track.look.add(sighting.look);
      track.size = known.size;
      track.since_s = known.since_s;
      track.body = std::move(known.body);
      lost.erase(lost.begin() + back);
      tracks.push_back(std::move(track));
    }
    Track& track = tracks.back();
    track.log_odds = std::clamp(logit(sighting.person.score), 0.F, std::log(options.odds));
    return track;
  }

  void forget(Track track) {
    lost.push_back(std::move(track));
    lost.back().place = {};
    lost.back().expected = {};
    while (lost.size() > static_cast<std::size_t>(options.remembered)) lost.pop_front();
  }

  void count(Track& track, float score, double passed_s) {
    const auto evidence = static_cast<float>(std::min(passed_s, kMostEvidence_s)) * kFramesASecond;
    track.log_odds = std::clamp(track.log_odds + evidence * logit(score), 0.F, std::log(options.odds));
  }

  /// Lets somebody fresh be sure who was found often and clearly enough.
  void confirm(Track& track, float score) const {
    if (track.state == TrackState::fresh) {
      track.evidence += logit(score);
      const float enough = static_cast<float>(options.confirm) * logit(kClearScore);
      if (track.found < options.confirm || track.evidence < enough) return;
    }
    track.state = TrackState::tracked;
  }

  bool is_sure(const Track& track) const { return track.state != TrackState::fresh; }

  TrackedPerson describe(const Track& track) const {
    TrackedPerson out;
    out.id = track.id;
    out.state = track.state;
    out.position = track.motion.position();
    out.velocity = track.motion.velocity();
    out.since_s = track.since_s;
    out.seen_s = track.seen_s;
    out.body = track.body;
    return out;
  }

  TrackedPerson describe_unseen(const Track& track, double time_s) const {
    TrackedPerson out = describe(track);
    const Eigen::Vector3f by = track.motion.position() - track.place_position;
    const auto unseen_s = static_cast<float>(std::clamp(time_s - track.seen_s, 0.0, 1e6));
    const float faded = std::exp(-kFadePerS * unseen_s);
    out.person = track.person;
    move(out.person, by, faded);
    if (out.body) move(*out.body, by, faded, track.motion.sigma_m());
    return out;
  }
};

PeopleTracker::PeopleTracker(const BodyModel& body, TrackOptions options, std::shared_ptr<const Appearance> appearance,
                             FitBody fit_body) {
  RangeCheck check;
  visit_options("track.", options, check);
  state_ = std::make_unique<State>(State{&body, options, std::move(appearance), std::move(fit_body), {}, 0, {}, {}});
}

PeopleTracker::~PeopleTracker() = default;
PeopleTracker::PeopleTracker(PeopleTracker&&) noexcept = default;
PeopleTracker& PeopleTracker::operator=(PeopleTracker&&) noexcept = default;

Prior PeopleTracker::expect(const Frame& frame) const {
  Prior prior;
  const Step step = state_->times.next(frame, state_->options);
  if (step.jump) return prior;
  std::vector<const Track*> known;
  for (const Track& track : state_->tracks) {
    if (step.time_s - track.seen_s <= kExpect_s) known.push_back(&track);
  }
  std::ranges::stable_sort(known, [](const Track* a, const Track* b) { return a->log_odds > b->log_odds; });
  if (known.size() > kMostExpected) known.resize(kMostExpected);
  for (const Track* track : known) {
    TrackMotion motion = track->motion;
    motion.predict(step.passed_s);
    Mask mask = track->place.expected(frame, track->place_position, motion.position());
    if (mask.empty()) continue;
    const bool is_sure = track->state != TrackState::fresh;  // a guess must not confirm itself
    prior.people.push_back({std::move(mask), track->look.histogram(), is_sure ? std::exp(track->log_odds) : 1.F});
  }
  return prior;
}

TrackedFrame PeopleTracker::update(const Frame& frame, std::vector<Person> people, const std::vector<Plane>& planes) {
  State& s = *state_;
  static_cast<void>(planes);
  std::vector<Sighting> sightings = s.look_at_all(frame, std::move(people));
  const Step step = s.times.next(frame, s.options);
  s.times.take(frame, step);
  TrackedFrame out;
  out.time_s = step.time_s;
  const auto lose = [&](Track& track) {
    if (!s.is_sure(track)) return;
    track.state = TrackState::lost;
    out.people.push_back(s.describe_unseen(track, step.time_s));
    s.forget(std::move(track));
  };
  if (step.jump) {
    for (Track& track : s.tracks) lose(track);
    s.tracks.clear();
  }
  for (Track& track : s.tracks) {
    track.motion.predict(step.passed_s);
    track.expected = track.place.expected(frame, track.place_position, track.motion.position());
  }
  std::vector<int> track_of = s.match(sightings, step.time_s);
  std::vector<bool> seen(s.tracks.size(), false);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (track_of[i] < 0) continue;
    Track& track = s.tracks[static_cast<std::size_t>(track_of[i])];
    const double passed_s = step.time_s - track.seen_s;
    if (track.state == TrackState::fresh && passed_s > static_cast<double>(s.options.confirm_s)) track.doubt();
    track.take(sightings[i], step.time_s);
    s.count(track, sightings[i].person.score, passed_s);
    s.confirm(track, sightings[i].person.score);
    seen[static_cast<std::size_t>(track_of[i])] = true;
  }
  // Those not found: the sure ones are hidden, and all are given up in time.
  std::vector<Track> staying;
  std::vector<int> place_of(s.tracks.size(), -1);
  for (std::size_t t = 0; t < s.tracks.size(); ++t) {
    Track& track = s.tracks[t];
    const double unseen_s = step.time_s - track.seen_s;
    const double most_s = static_cast<double>(s.is_sure(track) ? s.options.hidden_s : s.options.confirm_s);
    if (!seen[t] && unseen_s > most_s) {
      lose(track);
      continue;
    }
    if (!seen[t] && s.is_sure(track)) track.state = TrackState::hidden;
    place_of[t] = static_cast<int>(staying.size());
    staying.push_back(std::move(track));
  }
  s.tracks = std::move(staying);
  std::vector<int> sighting_of(s.tracks.size(), -1);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (track_of[i] >= 0)
      sighting_of[static_cast<std::size_t>(place_of[static_cast<std::size_t>(track_of[i])])] = static_cast<int>(i);
  }
  for (std::size_t i = 0; i < sightings.size() && s.tracks.size() < kMostTracks; ++i) {
    if (track_of[i] >= 0) continue;
    Track& track = s.begin(sightings[i], step.time_s);
    s.confirm(track, sightings[i].person.score);
    sighting_of.push_back(static_cast<int>(i));
  }
  if (s.fit_body) {
    parallel_for(static_cast<int>(s.tracks.size()), [&](int t) {
      if (sighting_of[t] >= 0) s.tracks[t].body = s.fit_body(frame, sightings[sighting_of[t]].person, s.tracks[t].body);
    });
  }
  for (std::size_t t = 0; t < s.tracks.size(); ++t) {
    const Track& track = s.tracks[t];
    if (sighting_of[t] >= 0) {
      TrackedPerson person = s.describe(track);
      person.person = std::move(sightings[static_cast<std::size_t>(sighting_of[t])].person);
      out.people.push_back(std::move(person));
    } else if (s.is_sure(track)) {
      out.people.push_back(s.describe_unseen(track, step.time_s));
    }
  }
  std::ranges::sort(out.people, {}, &TrackedPerson::id);
  std::ranges::sort(s.tracks, {}, &Track::id);
  return out;
}

}  // namespace vesalius
