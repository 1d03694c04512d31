#include "metrics/score_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "metrics/joint_metrics.h"
#include "metrics/match_people.h"
#include "vesalius/error.h"
#include "vesalius/frame_source.h"

namespace vesalius {
namespace {

constexpr std::array kStances{Stance::standing, Stance::sitting, Stance::lying, Stance::fallen, Stance::unknown};

/// Returns the stance that a word of the truth names; nothing for other postures.
std::optional<Stance> stance_of(const std::string& posture) {
  for (const Stance stance : kStances) {
    if (stance != Stance::unknown && posture == to_string(stance)) return stance;
  }
  return std::nullopt;
}

void check_people(const TrackedFrame& tracked, const Frame& frame, const BodyModel& body) {
  std::set<int> ids;
  for (const TrackedPerson& person : tracked.people) {
    const Person& found = person.person;
    if (!ids.insert(person.id).second) {
      throw Error(fmt::format("frame {}: two people of id {}", frame.name, person.id));
    }
    const bool fits = (found.mask.empty() || found.mask.same_size(frame.depth)) &&
                      found.skeleton.parts.size() == body.parts.size() &&
                      found.joints.size() == body.joint_sets.size() &&
                      (person.smoothed.empty() || person.smoothed.size() == body.joint_sets.size());
    if (fits) continue;
    throw Error(
        fmt::format("frame {}: person {} has a mask of another size, or other parts or joint sets than the body",
                    frame.name, person.id));
  }
}

/// Returns the indices of the people who are judged, the surest first, as score_found sorts them.
std::vector<std::size_t> order_of_visible(const TrackedFrame& tracked) {
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < tracked.people.size(); ++p) {
    if (tracked.people[p].state != TrackState::lost && has_pixels(tracked.people[p])) order.push_back(p);
  }
  std::ranges::stable_sort(order, std::ranges::greater{},
                           [&](std::size_t p) { return tracked.people[p].person.score; });
  return order;
}

/// Lets Joint::behind count in another order of the people.
void renumber(const std::vector<std::size_t>& order, TrackedFrame& tracked) {
  std::vector<int> number(tracked.people.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) number[order[i]] = int(i);
  for (TrackedPerson& person : tracked.people) {
    for (std::vector<Joint>& joints : person.person.joints) {
      for (Joint& joint : joints) {
        if (joint.behind >= 0) joint.behind = number.at(static_cast<std::size_t>(joint.behind));
      }
    }
  }
}

}  // namespace

FrameScore SequenceScorer::add(TrueFrame frame, TrackedFrame tracked) {
  judge_.check(frame);
  check_people(tracked, frame.frame, judge_.body());
  check_names(frame);
  put_visible_people_first(frame);
  const std::size_t index = samples_.size();
  for (TrackedPerson& person : tracked.people) {
    if (!person.smoothed.empty()) person.person.joints = person.smoothed;
    first_frame_.try_emplace(person.id, index);
  }
  const std::vector<std::size_t> order = order_of_visible(tracked);
  renumber(order, tracked);
  terms_.emplace_back();
  const std::optional<TrackPeople> people = track_people_of(frame, tracked, options_.hidden);
  TrackSample& sample = samples_.emplace_back();
  std::vector<const Person*> unseen;
  if (!people) ids_known_ = false;
  if (people && ids_known_) {
    sample = people->sample;
    const std::vector<int> match = matcher_.match(sample);
    follow(frame, *people, match, frame.frame.time_s.value_or(double(index) / kUsualRate));
    if (options_.hidden) unseen.resize(people->truth.size(), nullptr);
    for (std::size_t t = 0; t < unseen.size(); ++t) {
      if (match[t] >= 0 && !has_pixels(*people->found[match[t]])) {
        unseen[people->truth[t]] = &people->found[match[t]]->person;
      }
    }
  }
  std::vector<Person> visible;
  visible.reserve(order.size());
  for (const std::size_t p : order) visible.push_back(tracked.people[p].person);
  return judge_.score_found(std::move(frame), std::move(visible), unseen);
}

void SequenceScorer::check_names(const TrueFrame& frame) {
  const auto known = known_joints(frame.truth, judge_.body(), judge_.options().joint_set);
  if (!known) return;
  if (joint_names_.empty()) joint_names_ = known->names;
  if (known->names == joint_names_) return;
  throw Error(fmt::format("truth of frame {}: joints of other names than in the frames before", frame.frame.name));
}

void SequenceScorer::follow(const TrueFrame& frame, const TrackPeople& people, const std::vector<int>& match,
                            double time_s) {
  const BodyModel& body = judge_.body();
  const auto known = known_joints(frame.truth, body, judge_.options().joint_set);
  for (std::size_t t = 0; t < people.truth.size(); ++t) {
    const std::size_t who = people.truth[t];
    const TrackedPerson* found = match[t] >= 0 ? people.found[match[t]] : nullptr;
    if (found != nullptr) judge_stance(frame.truth, who, *found);
    if (!known || who >= known->of_person.size()) continue;
    MotionStep step{terms_.size() - 1, time_s, known->of_person[who], {}};
    step.true_bones_m = bone_lengths(frame.truth.joint_names, frame.truth.joints[who]);
    step.found_bones_m.fill(std::numeric_limits<double>::quiet_NaN());
    std::vector<Joint> joints;
    if (found != nullptr) {
      joints = found->person.joints[known->set - body.joint_sets.data()];
      step.found_bones_m = bone_lengths(body, known->set->name, found->person.joints);
      step.id = found->id;
      if (options_.trust) {
        add_trust_samples(*found, body.joint_sets, *known->set, known->names, known->of_person[who], trust_samples_);
      }
      step.track_age = int(step.frame - first_frame_.at(found->id));
    }
    step.found = joints_by_name(known->names, *known->set, joints);
    people_[people.sample.truth[t]].push_back(std::move(step));
  }
}

void SequenceScorer::judge_stance(const FrameTruth& truth, std::size_t person, const TrackedPerson& found) {
  const auto stance = stance_of(person < truth.postures.size() ? truth.postures[person] : truth.posture);
  if (!stance) return;
  if (options_.stances && found.posture && *stance != Stance::fallen) {
    stance_samples_.push_back({*found.posture, *stance});
  }
  // That somebody lies says nothing about how it came to that.
  const bool right = found.stance == *stance || (*stance == Stance::lying && found.stance == Stance::fallen);
  MetricTerms& terms = terms_.back();
  terms.push_back({Metric::stance_right, right ? 1.0 : 0.0, 1.0});
  for (const Stance given : kStances) {
    const int place = int(kStances.size()) * int(*stance) + int(given);
    terms.push_back({{Metric::stance_given, place, fmt::format("{}_as_{}", to_string(*stance), to_string(given))},
                     given == found.stance ? 1.0 : 0.0,
                     1.0});
  }
}

std::vector<MetricTerms> SequenceScorer::finish() {
  if (!ids_known_) return std::move(terms_);
  const std::vector<MetricTerms> tracks = track_terms(samples_);
  for (std::size_t frame = 0; frame < tracks.size(); ++frame) {
    terms_[frame].insert(terms_[frame].end(), tracks[frame].begin(), tracks[frame].end());
  }
  std::vector<PersonMotion> people;
  for (auto& [id, person] : people_) people.push_back(std::move(person));
  add_motion_terms(people, terms_);
  return std::move(terms_);
}

}  // namespace vesalius
