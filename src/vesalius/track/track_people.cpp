#include "vesalius/track_people.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <tuple>
#include <utility>

#include "vesalius/base/options.h"
#include "vesalius/error.h"
#include "vesalius/explain_unseen.h"
#include "vesalius/fit/fit_body.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_sections.h"
#include "vesalius/parallel.h"
#include "vesalius/prior.h"
#include "vesalius/track/match_tracks.h"
#include "vesalius/track/track.h"
#include "vesalius/track/track_clock.h"
#include "vesalius/track/track_floor.h"
#include "vesalius/track/track_stance.h"
#include "vesalius/track/track_view.h"
#include "vesalius/upright.h"

namespace vesalius {
namespace {

constexpr std::size_t kMostTracks = 128;   // at once: no camera sees so many
constexpr std::size_t kMostExpected = 16;  // of whom the detector is told, the surest ones
constexpr double kExpect_s = 1.0;          // after being seen; later nobody knows the place
constexpr float kRests = 0.6F;             // share of the pixels that are as they were where somebody still is ...
constexpr float kStillRests = 0.4F;        // ... and where somebody goes on resting who moves a little
constexpr float kSlow_m_s = 0.2F;          // at most, of somebody who rests
constexpr float kSamePlace_m = 1.F;        // of somebody new who is the one who lay there
constexpr double kNearlyAll = 0.8;         // of the pixels of somebody who is a piece of somebody else
constexpr double kSplit_s = 2.0;           // for which somebody new may be a piece of whoever is followed for longer
constexpr float kClearlyBetter = 0.1F;     // by which another lost person must look more different
constexpr float kFadePerS = 1.F;           // of the confidence of what is predicted of hidden people, per second

constexpr float kSurelyFound = 0.95F;        // least score of those for whom a part of the picture is enough
constexpr double kRegionLarger = 1.0 / 3.0;  // than the box about people
constexpr int kLeastRoom = 20;               // around it, in shares of the picture's width
constexpr double kLargestRegion = 0.6;       // share of the picture; of more there is nothing to gain

constexpr float kClearScore = 0.8F;  // that the frames in which somebody new is found have on average, at least

/// People are taken in an order of their own, so that ids do not depend on the list's.
bool comes_before(const Sighting& a, const Sighting& b) {
  const auto key = [](const Sighting& s) {
    const Eigen::Vector3f& at = s.trunk.position;
    return std::make_tuple(-s.person.score, at.x(), at.y(), at.z(), s.person.box.u, s.person.box.v);
  };
  return key(a) < key(b);
}

void check(const Person& person, const BodyModel& body) {
  const std::size_t parts = person.skeleton.parts.size(), voted = person.skeleton.voted.size();
  const std::size_t sets = person.joints.size(), of_body = body.parts.size();
  if (parts == of_body && (voted == 0 || voted == parts) && sets == body.joint_sets.size()) return;
  throw Error("track: a person has " + std::to_string(parts) + " parts, " + std::to_string(voted) + " voted ones and " +
              std::to_string(sets) + " joint sets, expected the body's " + std::to_string(of_body) +
              ", as many or none, and " + std::to_string(body.joint_sets.size()));
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
  for (VotedPart& part : person.skeleton.voted) part.centre += by;
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

void move(FittedBody& body, const Eigen::Vector3f& by, float unseen_s, float sigma_m, const BodyTrust& trust) {
  body.hidden = true;
  const auto distrust = [&](TrustSignals& signals, float& confidence) {
    signals.unseen_s = unseen_s;
    signals.log_sigma = 0.5F * std::log(std::exp(2.F * signals.log_sigma) + sigma_m * sigma_m);
    // Nobody is surer of a joint that is out of sight than of the same joint in sight.
    confidence = std::min(confidence, trusted(trust.hidden, signals));
  };
  for (FittedBone& bone : body.bones) {
    if (bone.state == State::none) continue;
    bone.state = State::predicted;
    bone.head += by;
    bone.tail += by;
    distrust(bone.of_head, bone.confidence);
    distrust(bone.of_tail, bone.tail_confidence);
    bone.covariance += sigma_m * sigma_m * Eigen::Matrix3f::Identity();
  }
}

TrackedPerson describe(const Track& track) {
  TrackedPerson out;
  out.id = track.id;
  out.state = track.state;
  out.position = track.motion.position();
  out.velocity = track.motion.velocity();
  out.since_s = track.since_s;
  out.seen_s = track.seen_s;
  out.stance = track.stance.stance();
  out.leaving = track.place.at_border();
  out.body = track.body;
  return out;
}

TrackedPerson describe_unseen(const Track& track, const BodyModel& body, const BodyFitter* fitter, double time_s) {
  TrackedPerson out = describe(track);
  if (track.rests) out.position = track.place_position;
  const Eigen::Vector3f by = out.position - track.place_position;
  const auto unseen_s = float(std::clamp(time_s - track.seen_s, 0.0, 1e6));
  const float faded = std::exp(-kFadePerS * unseen_s);
  out.person = track.person;
  move(out.person, by, faded);
  if (out.body && fitter != nullptr) {
    move(*out.body, by, unseen_s, track.motion.sigma_m(), fitter->trust());
    place_joints(*out.body, builtin_flesh_joints(), body, fitter->trust(), out.person.joints);
  }
  return out;
}

bool is_unchanged(const Track& track, const Frame& frame) {
  return !track.place.at_border() && track.place.unchanged(frame) >= (track.rests ? kStillRests : kRests);
}

/// Returns whether somebody who was found near the floor is still there, found or not: who is down does not vanish.
bool stays_down(const Track& track, const Frame& frame) { return track.stance.down() && is_unchanged(track, frame); }

/// Returns whether somebody is still as last found, found or not, and not about to go on.
bool rests(const Track& track, const Frame& frame) {
  const bool slow = track.stance.down() || track.motion.velocity().norm() <= kSlow_m_s;
  return slow && is_unchanged(track, frame);
}

/// Returns the box of somebody seen in the frame before with room around it, where the person has gone by now; empty if
/// that is unknown.
Box box_to_look_at(const Track& track, const Frame& frame, double passed_s) {
  TrackMotion motion = track.motion;
  motion.predict(passed_s);
  const Box& box = track.place.box();
  const Camera& camera = frame.camera;
  const std::optional<Eigen::Vector2i> moved = moved_pixels(camera, track.place_position, motion.position());
  if (box.width == 0 || !moved) return {};
  const auto room = [&](int side) {
    return std::max(camera.width / kLeastRoom, int(kRegionLarger / 2.0 * double(side)));
  };
  const int right = room(box.width), below = room(box.height);
  const int left_u = box.u + moved->x(), top_v = box.v + moved->y();
  const int u = std::max(0, left_u - right), v = std::max(0, top_v - below);
  const int end_u = std::min(camera.width, left_u + box.width + right);
  const int end_v = std::min(camera.height, top_v + box.height + below);
  if (end_u <= u || end_v <= v) return {};
  return {u, v, end_u - u, end_v - v};
}

/// Returns whether somebody found in a region of a frame may go on beyond it.
bool reaches_out(const std::vector<Person>& people, const Box& region, const Camera& camera) {
  return std::ranges::any_of(people, [&](const Person& person) {
    const Box& box = person.box;
    return (box.u <= region.u && region.u > 0) || (box.v <= region.v && region.v > 0) ||
           (box.u + box.width >= region.u + region.width && region.u + region.width < camera.width) ||
           (box.v + box.height >= region.v + region.height && region.v + region.height < camera.height);
  });
}

/// Returns the index of the sighting of which somebody's mask is a piece, or -1: nearly all of it, or half of it where
/// the other mask is twice as large, is the other's as well.
int whole_of(const Mask& full, const std::vector<Sighting>& sightings) {
  const Box box = bounding_box(full);
  const Mask mask = crop(full, box);
  const auto pixels = std::ranges::count_if(mask, [](std::uint8_t pixel) { return pixel != 0; });
  const auto found = std::ranges::find_if(sightings, [&](const Sighting& sighting) {
    if (!sighting.person.mask.same_size(full)) return false;
    const Mask other = crop(sighting.person.mask, box);
    long shared = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) shared += mask[i] != 0 && other[i] != 0 ? 1 : 0;
    const bool larger = sighting.place.pixels() >= 2 * pixels;
    return shared >= std::lround((larger ? 0.5 : kNearlyAll) * double(pixels));
  });
  return pixels == 0 || found == sightings.end() ? -1 : int(found - sightings.begin());
}

/// Gives somebody who was not found, but rests, the pixels that are as they were, unless they are a piece of somebody
/// who is found. Returns whether it did.
bool show_resting(const Track& track, const Frame& frame, const std::vector<Sighting>& sightings, TrackedPerson& out) {
  Mask mask = track.place.expected(frame, track.place_position, track.place_position);
  out.velocity.setZero();
  if (whole_of(mask, sightings) >= 0) return false;
  out.person.box = bounding_box(mask);
  out.person.labels = LabelImage(mask.width(), mask.height(), kBackground);
  out.person.mask = std::move(mask);
  return true;
}

bool is_sure(const Track& track) { return track.state != TrackState::fresh; }

}  // namespace

struct PeopleTracker::State {
  State(const BodyModel& model, const TrackOptions& given, std::shared_ptr<const Appearance> looks,
        std::shared_ptr<const BodyFitter> bodies)
      : kept(std::make_shared<const BodyModel>(model)),
        body(*kept),
        options(given),
        appearance(std::move(looks)),
        fitter(std::move(bodies)),
        clock(double(given.rate), double(given.gap_s)) {}

  std::optional<Sighting> look_at(const Frame& frame, Person person) const;
  std::vector<Sighting> look_at_all(const Frame& frame, std::vector<Person> people) const;
  std::vector<int> match(const std::vector<Sighting>& sightings, double time_s) const;
  int who_came_back(const Sighting& sighting, double time_s) const;
  Track begin(const Sighting& sighting, double time_s);
  void take_sighting(Track& track, const Sighting& sighting, double time_s) const;
  void count(Track& track, float score, double passed_s) const;
  void confirm(Track& track, float score) const;
  bool begun_at(const Track& stayed, const std::vector<Sighting>& sightings, const std::vector<int>& matched) const;
  std::vector<bool> rejoin(const Frame& frame, const std::vector<Sighting>& sightings, double time_s,
                           std::vector<int>& matched) const;
  double longest_unseen_s(const Track& track) const;
  void lose(Track track, double time_s, TrackedFrame& out, bool remember = true);
  void lose_all(double time_s, TrackedFrame& out);
  void predict(const Frame& frame, double passed_s);
  std::vector<int> follow(const Frame& frame, const std::vector<Sighting>& sightings, double time_s, TrackedFrame& out);
  void fit_bodies(const Frame& frame, const std::vector<int>& sighting_of, const TrackedFrame& out,
                  std::vector<Sighting>& sightings);
  void tell(const Frame& frame, const std::vector<int>& sighting_of, std::vector<Sighting> sightings,
            TrackedFrame& out);
  std::optional<Posture> take_stance(const Frame& frame, Track& track, const Person* found, TrackedFrame& out) const;
  void smooth(Track& track, TrackedPerson& person, double time_s) const;

  const std::shared_ptr<const BodyModel> kept;  ///< shared by copies
  const BodyModel& body;
  const TrackOptions options;
  const std::shared_ptr<const Appearance> appearance;
  const std::shared_ptr<const BodyFitter> fitter;
  TrackClock clock;
  TrackView view;
  TrackFloor floor;
  int last_id = 0;
  double latest_s = 0.0;      ///< time of the frame before
  std::vector<Track> tracks;  ///< by id
  std::deque<Track> lost;     ///< the last one lost comes last
};

std::optional<Sighting> PeopleTracker::State::look_at(const Frame& frame, Person person) const {
  check(person, body);
  if (!person.mask.same_size(frame.depth)) {
    person.mask = {};
    person.labels = {};
  }
  person.box = bounding_box(person.mask);
  const std::optional<TrunkPlace> trunk = trunk_place(person, frame, body);
  if (!trunk) return std::nullopt;
  Sighting sighting{std::move(person), *trunk, {}, {}, {}};
  const Person& found = sighting.person;
  sighting.scale = body_scale(found.skeleton, body);
  sighting.look = look_of(frame, found.mask, found.box, appearance.get());
  if (found.box.width > 0) sighting.place = TrackPlace(frame, found.mask, found.box);
  return sighting;
}

std::vector<Sighting> PeopleTracker::State::look_at_all(const Frame& frame, std::vector<Person> people) const {
  std::vector<std::optional<Sighting>> seen(people.size());
  parallel_for(int(people.size()), [&](int i) { seen[i] = look_at(frame, std::move(people[i])); });
  std::vector<Sighting> sightings;
  for (std::optional<Sighting>& sighting : seen) {
    if (sighting) sightings.push_back(std::move(*sighting));
  }
  std::ranges::stable_sort(sightings, comes_before);
  return sightings;
}

/// Returns for each track the index of its sighting, or -1.
std::vector<int> PeopleTracker::State::match(const std::vector<Sighting>& sightings, double time_s) const {
  Eigen::MatrixXf costs(static_cast<Eigen::Index>(tracks.size()), static_cast<Eigen::Index>(sightings.size()));
  parallel_for(int(tracks.size()), [&](int t) {
    for (std::size_t s = 0; s < sightings.size(); ++s) {
      costs(t, static_cast<Eigen::Index>(s)) =
          match_cost(tracks[t], sightings[s], appearance.get(), time_s, options.same_look);
    }
  });
  return match_tracks(costs, kMostMatchCost);
}

/// Returns the index of the lost person who is clearly this one, or -1.
int PeopleTracker::State::who_came_back(const Sighting& sighting, double time_s) const {
  std::vector<std::pair<float, int>> alike;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    // Others are rivals even where they look a little too different themselves.
    const std::optional<float> cost =
        return_cost(lost[i], sighting, appearance.get(), time_s, options.same_look + kClearlyBetter);
    if (cost) alike.emplace_back(*cost, int(i));
  }
  std::ranges::sort(alike);
  if (alike.empty() || alike[0].first > options.same_look) return -1;
  return alike.size() == 1 || alike[1].first - alike[0].first >= kClearlyBetter ? alike[0].second : -1;
}

/// Begins a track, under the old id if somebody clearly came back.
Track PeopleTracker::State::begin(const Sighting& sighting, double time_s) {
  const int back = who_came_back(sighting, time_s);
  Track track(back < 0 ? ++last_id : lost[static_cast<std::size_t>(back)].id, sighting, time_s);
  if (back >= 0) {
    Track& known = lost[static_cast<std::size_t>(back)];
    track.look = known.look;
    track.look.add_histogram(sighting.look);
    track.size = known.size;
    track.since_s = known.since_s;
    track.body = std::move(known.body);
    track.history = std::move(known.history);
    track.history.forget_pose();
    lost.erase(lost.begin() + back);
  }
  track.log_odds = std::clamp(score_log_odds(sighting.person.score), 0.F, std::log(options.odds));
  confirm(track, sighting.person.score);
  return track;
}

void PeopleTracker::State::count(Track& track, float score, double passed_s) const {
  const auto evidence = float(std::min(passed_s, kMostEvidence_s)) * kFramesASecond;
  track.log_odds = std::clamp(track.log_odds + evidence * score_log_odds(score), 0.F, std::log(options.odds));
}

/// Lets somebody fresh be sure who was found often and clearly enough.
void PeopleTracker::State::confirm(Track& track, float score) const {
  if (!is_sure(track)) {
    track.evidence += score_log_odds(score);
    const float enough = float(options.confirm) * score_log_odds(kClearScore);
    if (track.found < options.confirm || track.evidence < enough) return;
  }
  track.state = TrackState::tracked;
}

void PeopleTracker::State::take_sighting(Track& track, const Sighting& sighting, double time_s) const {
  const double passed_s = time_s - track.seen_s;
  if (!is_sure(track) && passed_s > double(options.confirm_s)) track.doubt();
  track.take_sighting(sighting, time_s);
  count(track, sighting.person.score, passed_s);
  confirm(track, sighting.person.score);
}

/// Returns whether somebody is found where `stayed` lay who is followed only since then: the same person, most likely.
bool PeopleTracker::State::begun_at(const Track& stayed, const std::vector<Sighting>& sightings,
                                    const std::vector<int>& matched) const {
  std::vector<bool> is_new(sightings.size(), true);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (matched[t] >= 0) is_new[static_cast<std::size_t>(matched[t])] = tracks[t].since_s > stayed.seen_s;
  }
  for (std::size_t s = 0; s < sightings.size(); ++s) {
    if (is_new[s] && (sightings[s].trunk.position - stayed.place_position).norm() <= kSamePlace_m) return true;
  }
  return false;
}

/// Joins people who are not found with those of whom they are a piece, if one of the two is new: whoever falls fast is
/// taken for two at first. The older one has the sighting. Returns who is gone.
std::vector<bool> PeopleTracker::State::rejoin(const Frame& frame, const std::vector<Sighting>& sightings,
                                               double time_s, std::vector<int>& matched) const {
  std::vector<bool> gone(tracks.size(), false);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    const Track& track = tracks[t];
    if (matched[t] >= 0 || track.place.unchanged(frame) < kRests) continue;
    const int whole = whole_of(track.place.expected(frame, track.place_position, track.place_position), sightings);
    const auto other = std::ranges::find(matched, whole);
    if (whole < 0 || other == matched.end()) continue;
    const auto o = static_cast<std::size_t>(other - matched.begin());
    const bool older = is_sure(track) && track.since_s < tracks[o].since_s;
    if (time_s - tracks[older ? o : t].since_s > kSplit_s) continue;
    gone[older ? o : t] = true;
    if (older) std::swap(matched[t], matched[o]);
  }
  return gone;
}

/// Returns the time after which somebody who is not found is given up.
double PeopleTracker::State::longest_unseen_s(const Track& track) const {
  if (!is_sure(track)) return double(options.confirm_s);
  return double(track.rests && track.stance.down() ? std::max(options.down_s, options.hidden_s) : options.hidden_s);
}

/// Gives a track up. Nobody is told of a guess.
void PeopleTracker::State::lose(Track track, double time_s, TrackedFrame& out, bool remember) {
  if (!is_sure(track)) return;
  track.state = TrackState::lost;
  out.people.push_back(describe_unseen(track, body, fitter.get(), time_s));
  if (!remember) return;
  track.place = {};
  track.expected = {};
  lost.push_back(std::move(track));
  while (lost.size() > static_cast<std::size_t>(options.remembered)) lost.pop_front();
}

void PeopleTracker::State::lose_all(double time_s, TrackedFrame& out) {
  for (Track& track : tracks) lose(std::move(track), time_s, out);
  tracks.clear();
}

void PeopleTracker::State::predict(const Frame& frame, double passed_s) {
  const std::optional<FloorView> ground = floor.view();
  parallel_for(int(tracks.size()), [&](int t) {
    Track& track = tracks[t];
    track.motion.predict(passed_s);
    if (ground) track.motion.stop_at(*ground);
    track.expected = track.place.expected(frame, track.place_position, track.motion.position());
  });
}

/// Gives each sighting to its track, or begins one for it. Whoever is not found is hidden, or lost after some time.
/// Returns for each track the index of its sighting, or -1.
std::vector<int> PeopleTracker::State::follow(const Frame& frame, const std::vector<Sighting>& sightings, double time_s,
                                              TrackedFrame& out) {
  std::vector<int> matched = match(sightings, time_s);
  const std::vector<bool> gone = rejoin(frame, sightings, time_s, matched);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    tracks[t].rests = matched[t] < 0 && rests(tracks[t], frame) && !begun_at(tracks[t], sightings, matched);
  }
  std::vector<Track> staying;
  std::vector<int> sighting_of;
  std::vector<bool> taken(sightings.size(), false);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    Track& track = tracks[t];
    if (matched[t] >= 0) {
      take_sighting(track, sightings[static_cast<std::size_t>(matched[t])], time_s);
      taken[static_cast<std::size_t>(matched[t])] = true;
    } else if (gone[t] || time_s - track.seen_s > longest_unseen_s(track)) {
      lose(std::move(track), time_s, out, !gone[t]);
      continue;
    } else if (is_sure(track)) {
      track.state = TrackState::hidden;
    }
    staying.push_back(std::move(track));
    sighting_of.push_back(matched[t]);
  }
  tracks = std::move(staying);
  for (std::size_t s = 0; s < sightings.size() && tracks.size() < kMostTracks; ++s) {
    if (taken[s]) continue;
    tracks.push_back(begin(sightings[s], time_s));
    sighting_of.push_back(int(s));
  }
  return sighting_of;
}

void PeopleTracker::State::fit_bodies(const Frame& frame, const std::vector<int>& sighting_of, const TrackedFrame& out,
                                      std::vector<Sighting>& sightings) {
  if (!fitter || !fitter->can_fit()) return;
  std::optional<Ground> ground;
  if (out.floor) ground = {out.floor->up.cast<double>(), double(out.floor->height_m)};
  parallel_for(int(tracks.size()), [&](int t) {
    if (sighting_of[t] < 0) return;
    Track& track = tracks[t];
    Person& person = sightings[static_cast<std::size_t>(sighting_of[t])].person;
    if (!person.mask.same_size(frame.depth)) return;
    track.body = track.history.fit(*fitter, frame, person, out.time_s, ground, track.motion.velocity().cast<double>());
    track.size.fit(track.history.size());
    if (track.body) place_joints(*track.body, builtin_flesh_joints(), body, fitter->trust(), person.joints);
    track.person.joints = person.joints;
  });
}

/// Takes what the frame tells of a track's stance, `found` being null for people who are not found. Returns it.
std::optional<Posture> PeopleTracker::State::take_stance(const Frame& frame, Track& track, const Person* found,
                                                         TrackedFrame& out) const {
  std::optional<Eigen::Vector3f> up = frame.up;
  std::optional<float> height_m;
  if (out.floor) {
    up = out.floor->up;
    height_m = out.floor->height_m;
  }
  std::optional<Posture> posture;
  if (up && found) {
    std::optional<PosedBody> posed;
    if (track.body && fitter) posed.emplace(PosedBody{*track.body, fitter->flesh()});
    posture = posture_of(*found, frame, body, *up, height_m, posed);
  }
  const Stance before = track.stance.stance();
  const auto changed = track.stance.update(posture, out.time_s);
  if (changed && is_sure(track)) out.events.push_back({track.id, changed->second, changed->first, before});
  return posture;
}

void PeopleTracker::State::smooth(Track& track, TrackedPerson& person, double time_s) const {
  if (!options.smooth) return;
  person.smoothed = track.smoother.smooth(person.person.joints, time_s - track.smoothed_s, options.smoothing);
  track.smoothed_s = time_s;
}

/// Adds all who are followed to `out`.
void PeopleTracker::State::tell(const Frame& frame, const std::vector<int>& sighting_of,
                                std::vector<Sighting> sightings, TrackedFrame& out) {
  // Those who are not found first, while the masks of the others are still here.
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    Track& track = tracks[t];
    if (sighting_of[t] >= 0 || !is_sure(track)) continue;
    TrackedPerson& told = out.people.emplace_back(describe_unseen(track, body, fitter.get(), out.time_s));
    if (track.rests) track.stance.hold(out.time_s);
    const bool shown = track.rests && show_resting(track, frame, sightings, told);
    told.posture = take_stance(frame, track, shown ? &told.person : nullptr, out);
    told.stance = track.stance.stance();
    smooth(track, told, out.time_s);
  }
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (sighting_of[t] < 0) continue;
    Track& track = tracks[t];
    Sighting& sighting = sightings[static_cast<std::size_t>(sighting_of[t])];
    const std::optional<Posture> posture = take_stance(frame, track, &sighting.person, out);
    TrackedPerson& told = out.people.emplace_back(describe(track));
    told.posture = posture;
    told.person = std::move(sighting.person);
    smooth(track, told, out.time_s);
  }
  std::ranges::sort(out.people, {}, &TrackedPerson::id);
  std::ranges::stable_sort(out.events, {}, &StanceEvent::id);
  std::ranges::sort(tracks, {}, &Track::id);
}

PeopleTracker::PeopleTracker(const BodyModel& body, TrackOptions options, std::shared_ptr<const Appearance> appearance,
                             std::shared_ptr<const BodyFitter> fitter) {
  RangeCheck check;
  visit_options("track.", options, check);
  state_ = std::make_unique<State>(body, options, std::move(appearance), std::move(fitter));
}

PeopleTracker::~PeopleTracker() = default;
PeopleTracker::PeopleTracker(const PeopleTracker& other) : state_(std::make_unique<State>(*other.state_)) {}
PeopleTracker& PeopleTracker::operator=(const PeopleTracker& other) { return *this = PeopleTracker(other); }
PeopleTracker::PeopleTracker(PeopleTracker&&) noexcept = default;
PeopleTracker& PeopleTracker::operator=(PeopleTracker&&) noexcept = default;

PeopleTracker PeopleTracker::restarted(TrackOptions options, std::shared_ptr<const Appearance> appearance,
                                       std::shared_ptr<const BodyFitter> fitter) const {
  PeopleTracker tracker(state_->body, options, std::move(appearance), std::move(fitter));
  tracker.state_->last_id = state_->last_id;
  return tracker;
}

PeopleTracker PeopleTracker::restarted() const {
  return restarted(state_->options, state_->appearance, state_->fitter);
}

Prior PeopleTracker::expect(const Frame& frame) const {
  Prior prior;
  const TrackStep step = state_->clock.step_to(frame);
  if (step.jump) return prior;
  std::vector<const Track*> known;
  for (const Track& track : state_->tracks) {
    if (step.time_s - track.seen_s <= kExpect_s || stays_down(track, frame)) known.push_back(&track);
  }
  std::ranges::stable_sort(known, [](const Track* a, const Track* b) { return a->log_odds > b->log_odds; });
  if (known.size() > kMostExpected) known.resize(kMostExpected);
  for (const Track* track : known) {
    Mask mask;
    std::vector<Capsule> flesh;
    std::optional<BodyState> pose;
    if (state_->fitter) pose = track->history.expected_state(state_->fitter->flesh(), step.time_s);
    if (pose) {
      flesh = flesh_capsules(state_->fitter->flesh(), *pose);
    } else {
      TrackMotion motion = track->motion;
      motion.predict(step.passed_s);
      const bool stays = step.time_s - track->seen_s > kExpect_s;
      mask = track->place.expected(frame, track->place_position, stays ? track->place_position : motion.position());
    }
    if (mask.empty() && flesh.empty()) continue;
    const float odds = is_sure(*track) ? std::exp(track->log_odds) : 1.F;  // a guess must not confirm itself
    prior.people.push_back(
        {std::move(mask), track->look.histogram(), odds, std::move(flesh), track->history.size().value_or(1.F)});
  }
  return prior;
}

bool PeopleTracker::knows_regions() const { return state_->options.whole_s > 0.F; }

std::optional<PictureRegion> PeopleTracker::region(const Frame& frame) const {
  const State& s = *state_;
  const TrackStep step = s.clock.step_to(frame);
  const bool long_ago = !(step.time_s - s.view.time_s() < double(s.options.whole_s));
  if (step.jump || long_ago || s.tracks.empty()) return std::nullopt;
  Box box;
  for (const Track& track : s.tracks) {
    if (track.person.score < kSurelyFound) return std::nullopt;
    const Box own = track.seen_s < s.latest_s ? Box{} : box_to_look_at(track, frame, step.passed_s);
    if (own.width == 0) return std::nullopt;
    box = around(box, own);
  }
  const double share = double(box.width) * double(box.height) / double(frame.depth.size());
  if (share > kLargestRegion || !s.view.unchanged(frame, box)) return std::nullopt;
  return PictureRegion{box, s.view.planes()};
}

TrackedFrame PeopleTracker::update(const Frame& frame, Detection found) {
  State& s = *state_;
  check(frame);
  std::vector<Sighting> sightings = s.look_at_all(frame, std::move(found.people));
  const TrackStep step = s.clock.step_to(frame);
  s.clock.go(frame);
  TrackedFrame out;
  out.time_s = step.time_s;
  if (step.jump) {
    s.lose_all(step.time_s, out);
    s.floor.reset();
  }
  if (found.whole) {
    Box people;
    for (const Sighting& sighting : sightings) people = around(people, sighting.person.box);
    s.view.take_frame(frame, step.time_s, found.planes, people);
  }
  s.floor.update(found.planes, frame.up, step.passed_s, guessed_up(frame));
  out.floor = s.floor.view();
  s.latest_s = step.time_s;
  s.predict(frame, step.passed_s);
  const std::vector<int> sighting_of = s.follow(frame, sightings, step.time_s, out);
  s.fit_bodies(frame, sighting_of, out, sightings);
  s.tell(frame, sighting_of, std::move(sightings), out);
  explain_unseen(frame, s.body, out);
  return out;
}

PeopleTracker make_tracker(const Detector& detector, const PeopleOptions& options) {
  return PeopleTracker(detector.body(), options.track, detector.appearance(),
                       std::make_shared<const BodyFitter>(detector.body(), options.fit));
}

TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame) {
  FollowReport report;
  return follow(detector, tracker, frame, report);
}

TrackedFrame follow(const Detector& detector, PeopleTracker& tracker, const Frame& frame, FollowReport& report) {
  const auto timed = [&](const auto& work) { report.track_ms += elapsed_ms(work); };
  const AskPrior ask = [&](const Frame& asked) {
    if (report.wait) report.wait();
    Prior prior;
    timed([&] { prior = tracker.expect(asked); });
    return prior;
  };
  std::optional<PictureRegion> region;
  if (tracker.knows_regions() && report.trace == nullptr) {
    if (report.wait) report.wait();
    timed([&] { region = tracker.region(frame); });
  }
  Detection found = detector.detect(frame, region, ask, report.trace, &report.times);
  if (region && reaches_out(found.people, region->box, frame.camera)) {
    found = detector.detect(frame, ask, nullptr, &report.times);
  }
  report.planes = found.planes;
  TrackedFrame followed;
  timed([&] { followed = tracker.update(frame, std::move(found)); });
  return followed;
}

}  // namespace vesalius
