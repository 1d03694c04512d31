#include "vesalius/detect.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "vesalius/base/blended_depth.h"
#include "vesalius/base/options.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/pool.h"
#include "vesalius/default_judge.h"
#include "vesalius/derive_joints.h"
#include "vesalius/error.h"
#include "vesalius/explain_unseen.h"
#include "vesalius/find_clusters.h"
#include "vesalius/forest/facing.h"
#include "vesalius/group_votes.h"
#include "vesalius/grow_person.h"
#include "vesalius/known_people.h"
#include "vesalius/label_scene.h"
#include "vesalius/parallel.h"
#include "vesalius/predict_parts.h"
#include "vesalius/prior.h"
#include "vesalius/propose_people.h"
#include "vesalius/score_person.h"
#include "vesalius/search_skeletons.h"
#include "vesalius/trace.h"
#include "vesalius/upright.h"
#include "vesalius/vote_parts.h"

namespace vesalius {
namespace {

/// Returns a judge that asks for all evidence, in its order. One without names was fitted before there were votes.
BoostedTrees judge_in_order(const BoostedTrees& judge, const BodyModel& body) {
  std::vector<std::string> names = judge_names(body);
  if (judge.asks.empty()) names.resize(names.size() - kVotedEvidence.size());
  return in_order(judge, names, "judge of people");
}

}  // namespace

/// The data that all frames share, and memory that they reuse.
struct Method {
  /// `model` has a labeller.
  Method(Model model, const DetectOptions& given, std::shared_ptr<const Appearance> looks)
      : judge(judge_in_order(model.judge.empty() ? default_judge() : model.judge, model.body)),
        labeller(std::move(model), {given.label, given.smooth, given.grow.plane}),
        options(given),
        appearance(looks != nullptr ? std::move(looks) : make_appearance(given.grow.appearance)),
        body(labeller.body()) {}

  float score(const Evidence& evidence) const { return judge.probability(judge_features(evidence)); }

  BoostedTrees judge;  ///< judge_in_order
  SceneLabeller labeller;
  DetectOptions options;
  std::shared_ptr<const Appearance> appearance;  ///< none if looks do not matter
  const BodyModel& body;
  mutable Pool<SceneLabels> memory;
};

namespace {

using Candidate = Trace::Candidate;

/// Runs sections 4 to 6 on the whole picture. Planes that are `known` are not searched for.
Scene first_pass(const Method& method, const Frame& frame, const std::vector<Plane>* known, StageClock& clock) {
  const DetectOptions& options = method.options;
  Scene scene;
  scene.labels = method.labeller.label_scene(frame, clock, method.memory.take(), known);
  // Every pixel that may be a part is proposed as one. The score later separates people from the rest.
  scene.proposals = method.labeller.choose(scene.labels, frame, options.label.proposal_weight);
  clock.lap(Stage::choose);
  scene.clusters = find_clusters(scene.proposals, frame.depth, frame.camera, method.body, options.cluster);
  clock.lap(Stage::cluster);
  scene.rough = search_skeletons(scene.clusters.items, method.body, options.search);
  scene.groups = group_votes(scene.labels.raw, frame, method.body.part_count());
  clock.lap(Stage::search);
  return scene;
}

/// Searches for a known person's skeleton where the person is expected, and grows it with the known appearance. Whose
/// flesh is known has a mask already.
std::optional<Candidate> grow_known(const Method& method, const Frame& frame, const Scene& scene, const Prior& prior,
                                    int index, const PersonGrower& grower) {
  const Prior::KnownPerson& known = prior.people[static_cast<std::size_t>(index)];
  Candidate candidate;
  candidate.known = index;
  if (!known.flesh.empty()) {
    candidate.rough.parts.resize(method.body.parts.size());
    candidate.grown = known.mask;
    candidate.group = main_group(scene.groups, candidate.grown);
    return candidate;
  }
  candidate.labels = method.labeller.label_person(scene.labels, frame, known.mask, bounding_box(known.mask)).labels;
  const Clusters clusters =
      find_clusters(candidate.labels, frame.depth, frame.camera, method.body, method.options.cluster);
  std::vector<Skeleton> rough = search_skeletons(clusters.items, method.body, method.options.search, known.size);
  if (rough.empty()) return std::nullopt;
  candidate.rough = std::move(rough.front());
  candidate.grown = std::move(grower.grow({candidate.rough}, clusters, {known.appearance})[0]);
  candidate.group = main_group(scene.groups, candidate.grown);
  return candidate;
}

/// Returns the best skeleton of a candidate's labels, which are within `box`, or one without parts if there is none.
/// It has at least `min_parts`. `size` is that of the person (search_skeletons).
Skeleton second_pass(const Method& method, const Frame& frame, const LabelImage& labels, const Box& box, int min_parts,
                     float size) {
  ClusterOptions options = method.options.cluster;
  constexpr float scale = 0.5F;  // of the smallest area of a part: in the second pass all pixels are a person's
  options.min_area_cm2 *= scale;
  options.min_pixels = std::max(1, int(float(options.min_pixels) * scale));
  const Clusters clusters =
      find_clusters(crop(labels, box), crop(frame.depth, box), cropped(frame.camera, box), method.body, options);
  SearchOptions search = method.options.search;
  search.min_parts = min_parts;
  std::vector<Skeleton> found = search_skeletons(clusters.items, method.body, search, size);
  return found.empty() ? Skeleton{} : std::move(found.front());
}

/// Returns whether most of a skeleton's paired parts lie nearer to the other's part of the opposite side than to its
/// part of the same side.
bool swaps_sides(const Skeleton& skeleton, const Skeleton& other, const BodyModel& body) {
  int swapped = 0, compared = 0;
  for (int p = 0; p < body.part_count(); ++p) {
    const int mirror = body.parts[p].mirror;
    if (mirror < 0 || mirror == p || skeleton.parts[p].state != State::observed) continue;
    const auto distance = [&](int part) {
      const bool there = other.parts[part].state == State::observed;
      return there ? (skeleton.parts[p].centre - other.parts[part].centre).norm() : std::numeric_limits<float>::max();
    };
    const float same = distance(p), opposite = distance(mirror);
    compared += same != opposite ? 1 : 0;
    swapped += opposite < same ? 1 : 0;
  }
  return 2 * swapped > compared;
}

/// Runs the same stages on one person a second time, and keeps the likelier of the two skeletons. Where the person's
/// heading is known, a first one whose sides contradict it is not kept: it was found in labels of single pixels.
Candidate refine(const Method& method, const Frame& frame, const Scene& scene, const Scenery& scenery,
                 const Prior& prior, Candidate candidate) {
  const Box box = bounding_box(candidate.grown);
  if (box.width == 0) return candidate;
  PersonLabels person;
  if (method.options.refine.second_pass) {
    person = method.labeller.label_person(scene.labels, frame, candidate.grown, box);
    const float size = candidate.known < 0 ? 1.F : prior.people[static_cast<std::size_t>(candidate.known)].size;
    const int min_parts = candidate.group < 0 ? method.options.search.min_parts : 1;
    candidate.refined = second_pass(method, frame, person.labels, box, min_parts, size);
  } else {
    person.labels = candidate.labels.empty() ? scene.proposals : candidate.labels;
    person.certain = mean_certainty(scene.labels.posteriors(), candidate.grown, method.body.part_count());
  }
  const auto contradicted = [&] {
    return person.facing.size() > 0 && swaps_sides(candidate.rough, candidate.refined, method.body);
  };
  if (candidate.refined.found == 0 || (candidate.refined.score < candidate.rough.score && !contradicted())) {
    candidate.refined = candidate.rough;
  }
  candidate.evidence =
      gather_evidence(frame, candidate.grown, person, scene.labels.smooth, scenery, candidate.refined, method.body);
  if (candidate.group >= 0) {
    const VoteGroup& group = scene.groups.items[candidate.group];
    add_votes(frame, candidate.grown, scene.labels.raw.votes, group, candidate.refined, method.body,
              candidate.evidence);
    if (group.heading.confidence > 0.F) candidate.yaw = group.heading;
  }
  if (person.facing.size() > 0) candidate.yaw = estimate_yaw(person.facing);
  const PartVotes& votes = scene.labels.raw.part_votes;
  if (votes.parts == method.body.part_count()) candidate.refined.voted = vote_parts(votes, frame, candidate.grown);
  candidate.score = method.score(candidate.evidence);
  candidate.labels = std::move(person.labels);
  candidate.points = std::move(person.points);
  return candidate;
}

constexpr float kSurelyKnown = 0.5F;  // overlap of masks from which they are surely of the same person

/// Returns the probability that a candidate is a person, given its score and who is known. Of several known people
/// whom it covers, the likeliest counts.
float certainty_of(const Candidate& candidate, const Prior& prior) {
  std::optional<float> odds;
  for (std::size_t i = 0; i < prior.people.size(); ++i) {
    const Prior::KnownPerson& known = prior.people[i];
    if (known.mask.empty()) continue;
    const bool own = candidate.known == int(i);
    if (own || shared_pixels(candidate.grown, known.mask) >= kKnownOverlap) {
      odds = std::max(odds.value_or(known.odds), known.odds);
    }
  }
  if (!odds || *odds == 1.F) return candidate.score;
  return *odds * candidate.score / (1.F - candidate.score + *odds * candidate.score);
}

/// Adds the pixels of a mask to others.
void take(const Mask& mask, Mask& taken) {
  std::transform(taken.begin(), taken.end(), mask.begin(), taken.begin(), std::bit_or<>());
}

Scenery look_around(const Method& method, const Frame& frame, const Scene& scene,
                    const std::vector<Candidate>& candidates) {
  Mask anybody(frame.camera.width, frame.camera.height, 0);
  for (const Candidate& candidate : candidates) take(candidate.grown, anybody);
  return {scene.labels.flat, mean_body_outside(anybody, frame.depth, scene.labels.smooth, method.body.part_count()),
          int(scene.rough.size()), int(scene.groups.items.size())};
}

/// Refines candidates, among all others whose masks are known so far.
void refine_all(const Method& method, const Frame& frame, const Scene& scene, const Scenery& scenery,
                const Prior& prior, std::span<Candidate> candidates) {
  parallel_for(int(candidates.size()), [&](int i) {
    candidates[i] = refine(method, frame, scene, scenery, prior, std::move(candidates[i]));
    candidates[i].certainty = certainty_of(candidates[i], prior);
  });
}

/// Returns whether a candidate has as many parts as a person needs. Where votes agree, one large part can be a person.
bool has_enough_parts(const Candidate& candidate, const RefineOptions& options) {
  const bool voted = candidate.group >= 0 && !candidate.refined.parts.empty();
  return candidate.refined.found >= options.min_parts || voted;
}

/// Returns the known people whom no candidate that would pass anyway covers or shows elsewhere.
std::vector<int> missed_people(const Method& method, const Prior& prior, const std::vector<Candidate>& candidates) {
  const RefineOptions& options = method.options.refine;
  std::vector<int> missed;
  for (std::size_t i = 0; i < prior.people.size(); ++i) {
    const Mask& mask = prior.people[i].mask;
    if (mask.empty()) continue;
    const bool found = std::ranges::any_of(candidates, [&](const Candidate& candidate) {
      if (candidate.score < options.min_score || !has_enough_parts(candidate, options)) return false;
      const bool moved = candidate.elsewhere && candidate.known == int(i);
      return moved || shared_pixels(candidate.grown, mask) >= kSurelyKnown;
    });
    if (!found) missed.push_back(int(i));
  }
  return missed;
}

/// Adds a refined candidate for each of the known people whom the others miss.
void add_known(const Method& method, const Frame& frame, const Scene& scene, const Looks& looks, const Prior& prior,
               std::vector<Candidate>& candidates) {
  const std::vector<int> missed = missed_people(method, prior, candidates);
  if (missed.empty()) return;
  // The background's posterior does not hold back known people.
  const PersonGrower grower(frame, scene.labels.flat, method.body, method.options.grow, looks);
  std::vector<std::optional<Candidate>> grown(missed.size());
  parallel_for(int(missed.size()),
               [&](int i) { grown[i] = grow_known(method, frame, scene, prior, missed[i], grower); });
  const std::size_t others = candidates.size();
  for (std::optional<Candidate>& candidate : grown) {
    if (candidate) candidates.push_back(std::move(*candidate));
  }
  refine_all(method, frame, scene, look_around(method, frame, scene, candidates), prior,
             std::span(candidates).subspan(others));
}

/// Returns whether most of the mask is already taken.
bool repeats(const Mask& mask, const Mask& taken, float max_overlap) {
  std::uint32_t pixels = 0, shared = 0;
  const std::uint8_t *of_mask = mask.data(), *of_taken = taken.data();
  for (std::size_t i = 0; i < taken.size(); ++i) {  // without branches, for vectors
    const std::uint32_t in_mask = of_mask[i] != 0 ? 1 : 0, in_taken = of_taken[i] != 0 ? 1 : 0;
    pixels += in_mask;
    shared += in_mask & in_taken;
  }
  return float(shared) > max_overlap * float(pixels);
}

Person make_person(const BodyModel& body, const Candidate& candidate, const Mask& taken) {
  Person person;
  person.skeleton = candidate.refined;
  predict_missing_parts(body, person.skeleton);
  person.joints = derive_joints(body, person.skeleton);
  person.score = candidate.score;
  person.yaw = candidate.yaw;
  person.mask = candidate.grown;
  person.labels = candidate.labels;
  person.points = candidate.points;
  const auto free = [](std::uint8_t in, std::uint8_t is_taken) { return is_taken != 0 ? std::uint8_t{0} : in; };
  const auto inside = [](std::uint8_t label, std::uint8_t in) { return in != 0 ? label : kBackground; };
  std::transform(person.mask.begin(), person.mask.end(), taken.begin(), person.mask.begin(), free);
  std::transform(person.labels.begin(), person.labels.end(), person.mask.begin(), person.labels.begin(), inside);
  person.box = bounding_box(person.mask);
  return person;
}

/// Returns whether a candidate is taken for somebody whose body is known, so that it needs no parts of its own.
bool is_followed(const Candidate& candidate, const Prior& prior) {
  if (candidate.known < 0) return false;
  const Prior::KnownPerson& known = prior.people[static_cast<std::size_t>(candidate.known)];
  return !known.flesh.empty() && known.odds > 1.F;
}

/// Returns whether a candidate whose pixels vote for the middle of somebody else is a piece of that person: only what
/// earlier frames say makes it a second one, or they say it of a guess.
bool is_piece(const Candidate& candidate, const Prior& prior, float min_score) {
  if (candidate.known < 0) return false;
  return candidate.score < min_score || prior.people[static_cast<std::size_t>(candidate.known)].odds <= 1.F;
}

/// Gives a person the pixels of a candidate that vote for the middle of this group and are not taken, and takes them.
void add_piece(const Candidate& piece, const VoteGroups& groups, Mask& taken, Person& person) {
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (piece.grown[i] == 0 || taken[i] != 0 || groups.index[i] != piece.group) continue;
    person.mask[i] = taken[i] = 1;
    person.labels[i] = piece.labels.empty() ? kBackground : piece.labels[i];
  }
  person.box = bounding_box(person.mask);
}

/// Returns those candidates that are people, and marks them as accepted. `candidates` are sorted by certainty. A
/// candidate that mostly repeats a more certain one is dropped; pixels that two share belong to the more certain one.
std::vector<Person> choose_people(const Method& method, const Frame& frame, const Prior& prior,
                                  const VoteGroups& groups, std::vector<Candidate>& candidates) {
  const RefineOptions& options = method.options.refine;
  std::vector<Person> people;
  std::map<int, std::size_t> first_of;  // index of the first person of each group
  Mask taken(frame.camera.width, frame.camera.height, 0);
  for (Candidate& candidate : candidates) {
    const auto first = first_of.find(candidate.group);
    if (first != first_of.end() && is_piece(candidate, prior, options.min_score)) {
      add_piece(candidate, groups, taken, people[first->second]);
      continue;
    }
    const bool few = !has_enough_parts(candidate, options) && !is_followed(candidate, prior);
    if (candidate.certainty < options.min_score || few) continue;
    if (repeats(candidate.grown, taken, options.max_overlap)) continue;
    candidate.accepted = true;
    if (candidate.group >= 0) first_of.emplace(candidate.group, people.size());
    people.push_back(make_person(method.body, candidate, taken));
    take(people.back().mask, taken);
  }
  return people;
}

/// Labels everybody whose pixels have a number of their own in `people`, as the second pass does.
LabelImage label_people(const Method& method, const SceneLabels& scene, const Frame& frame, const Mask& people) {
  LabelImage labels(people.width(), people.height(), kBackground);
  const std::set<std::uint8_t> numbers(people.begin(), people.end());
  for (const std::uint8_t number : numbers) {
    if (number == 0) continue;
    Mask one(people.width(), people.height(), 0);
    for (std::size_t i = 0; i < one.size(); ++i) one[i] = people[i] == number ? 1 : 0;
    const LabelImage inside = method.labeller.label_person(scene, frame, one, bounding_box(one)).labels;
    for (std::size_t i = 0; i < one.size(); ++i) {
      if (one[i] != 0 || labels[i] == kBackground) labels[i] = inside[i];
    }
  }
  return labels;
}

/// `person` is Trace::person on the grid.
void fill(Trace& trace, const Method& method, const Frame& frame, Scene& scene, std::vector<Candidate> candidates,
          const Mask& person) {
  trace.raw_labels = method.labeller.choose_raw(scene.labels, frame);
  trace.labels = method.labeller.choose(scene.labels, frame, method.options.label.background_weight);
  trace.clusters = std::move(scene.clusters);
  trace.rough = std::move(scene.rough);
  trace.flat = scene.labels.flat;
  trace.candidates = std::move(candidates);
  trace.inside = {};
  if (!person.empty()) trace.inside = label_people(method, scene.labels, frame, person);
}

long pixels_of(const Mask& mask) {
  return std::ranges::count_if(mask, [](std::uint8_t pixel) { return pixel != 0; });
}

/// Takes candidates for known people of whom little is where they are expected, and votes for the same middle as the
/// candidate does: they moved otherwise, and what is there is a piece of them.
void show_by_votes(const Prior& prior, const VoteGroups& groups, std::vector<Candidate>& candidates) {
  constexpr long kWhole = 4;  // times the pixels of the piece
  for (std::size_t i = 0; i < prior.people.size(); ++i) {
    const Prior::KnownPerson& known = prior.people[i];
    const auto is_shown = [&](const Candidate& candidate) { return candidate.known == int(i); };
    if (known.flesh.empty() || std::ranges::any_of(candidates, is_shown)) continue;
    const int group = main_group(groups, known.mask);
    const auto whole = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
      return group >= 0 && candidate.group == group && candidate.known < 0 &&
             pixels_of(candidate.grown) >= kWhole * pixels_of(known.mask);
    });
    if (whole == candidates.end()) continue;
    whole->known = int(i);
    whole->elsewhere = true;
  }
}

/// Runs the method on one frame of any size. Planes that are `known` are not searched for.
Detection detect_everywhere(const Method& method, const Frame& frame, const std::vector<Plane>* known_planes,
                            const std::function<Prior()>& ask, Trace* trace, const Mask& person, StageTimes* times) {
  StageClock clock(times);
  Scene scene = first_pass(method, frame, known_planes, clock);
  Prior prior = ask();
  clock.skip();  // the time that others took
  const KnownPeople known(frame, scene.labels.flat, scene.labels.smooth, method.body.part_count(), prior);
  Looks looks;
  if (!scene.rough.empty() || !scene.groups.items.empty() || !prior.people.empty())
    looks = look_at(frame, method.appearance.get());
  std::vector<Candidate> candidates = propose_people(frame, scene, looks, method.body, method.options);
  parallel_for(int(candidates.size()), [&](int i) { candidates[i].known = known.shown_by(candidates[i].grown); });
  show_by_votes(prior, scene.groups, candidates);
  parallel_for(int(candidates.size()),
               [&](int i) { known.correct(candidates[i].known, !candidates[i].elsewhere, candidates[i].grown); });
  clock.lap(Stage::grow);
  refine_all(method, frame, scene, look_around(method, frame, scene, candidates), prior, candidates);
  add_known(method, frame, scene, looks, prior, candidates);
  clock.lap(Stage::second_pass);
  std::ranges::stable_sort(candidates,
                           [](const Candidate& a, const Candidate& b) { return a.certainty > b.certainty; });
  Detection found{choose_people(method, frame, prior, scene.groups, candidates), scene.labels.planes};
  clock.lap(Stage::people);
  if (trace != nullptr) fill(*trace, method, frame, scene, std::move(candidates), person);
  method.memory.give_back(std::move(scene.labels));
  return found;
}

FrameLabels label_everywhere(const Method& method, const Frame& frame, const Mask* person) {
  StageClock clock(nullptr);
  SceneLabels scene = method.labeller.label_scene(frame, clock, method.memory.take());
  FrameLabels labels;
  labels.labels = method.labeller.choose(scene, frame, method.options.label.background_weight);
  if (person != nullptr) labels.inside = label_people(method, scene, frame, *person);
  method.memory.give_back(std::move(scene));
  return labels;
}

}  // namespace

Detector::Detector(Model model, DetectOptions options, std::shared_ptr<const Appearance> appearance) {
  RangeCheck check;
  visit_options("", options, check);
  method_ = std::make_shared<const Method>(on_device(std::move(model)), options, std::move(appearance));
}

namespace {

/// Finds the people in an upright picture. Planes that are `known` are not searched for.
Detection detect_upright(const Method& method, const Frame& given, const GridOptions& grid_options,
                         const std::vector<Plane>* known, const AskPrior& ask, Trace* trace, StageTimes* times) {
  StageClock clock(times);
  const std::optional<DepthImage> cleared = without_blended(given.depth, method.options.blend);
  clock.lap(Stage::grid);
  return on_grid(
      given, cleared ? *cleared : given.depth, grid_options, times,
      [&](const Frame& grid, int step) {
        const bool has_person = trace != nullptr && trace->person != nullptr;
        const Mask person = has_person ? every_nth(*trace->person, step) : Mask{};
        const auto ask_on_grid = [&] {
          const Prior prior = ask(given);
          check(prior, given);
          return every_nth(prior, step);
        };
        return detect_everywhere(method, grid, known, ask_on_grid, trace, person, times);
      },
      [&](const GridGuide& guide, Detection& found) {
        for (Person& person : found.people) enlarge(guide, person);
        if (trace != nullptr) enlarge(guide, *trace);
      });
}

/// Finds the people in a part of an upright picture.
Detection detect_within(const Method& method, const Frame& given, const PictureRegion& region, const AskPrior& ask,
                        StageTimes* times) {
  GridOptions grid;
  grid.step = grid_step(given.camera, method.options.grid);
  const Box box = in_blocks(region.box, given.camera, grid.step);
  const auto ask_within = [&](const Frame&) {
    Prior prior = ask(given);
    check(prior, given);
    return cropped(std::move(prior), box);
  };
  Detection found = detect_upright(method, cropped(given, box), grid, &region.planes, ask_within, nullptr, times);
  found.whole = false;
  for (Person& person : found.people) {
    person.mask = uncropped(person.mask, box, given.camera, std::uint8_t{0});
    person.labels = uncropped(person.labels, box, given.camera, kBackground);
    person.box.u += box.u;
    person.box.v += box.v;
  }
  return found;
}

/// Finds the people in the upright frame and turns them back.
Detection detect_turned(const Detector& detector, const Frame& given, int quarters,
                        const std::optional<PictureRegion>& region, const AskPrior& ask, Trace* trace,
                        StageTimes* times) {
  const auto ask_turned = [&](const Frame&) {
    Prior prior = ask(given);
    check(prior, given);
    return turned(std::move(prior), quarters);
  };
  Mask person;
  Trace upright;
  if (trace != nullptr && trace->person != nullptr) {
    person = turned(*trace->person, quarters);
    upright.person = &person;
  }
  std::optional<PictureRegion> within;
  if (region) within = turned(*region, given.camera, quarters);
  Detection found =
      detector.detect(turned(given, quarters), within, ask_turned, trace != nullptr ? &upright : nullptr, times);
  if (trace != nullptr) {
    upright.person = trace->person;
    *trace = turned(std::move(upright), 4 - quarters);
  }
  return turned(std::move(found), 4 - quarters);
}

}  // namespace

Detection Detector::detect(const Frame& given, const std::optional<PictureRegion>& region, const AskPrior& ask,
                           Trace* trace, StageTimes* times) const {
  check(given);
  if (region) check(*region, given);
  if (const int quarters = quarters_to_upright(given); quarters != 0) {
    return detect_turned(*this, given, quarters, region, ask, trace, times);
  }
  Detection detection = region && trace == nullptr
                            ? detect_within(*method_, given, *region, ask, times)
                            : detect_upright(*method_, given, method_->options.grid, nullptr, ask, trace, times);
  explain_unseen(given, method_->body, detection.people);
  return detection;
}

Detection Detector::detect(const Frame& frame, const AskPrior& ask, Trace* trace, StageTimes* times) const {
  return detect(frame, std::nullopt, ask, trace, times);
}

std::vector<Person> Detector::detect(const Frame& frame, const Prior& prior, Trace* trace, StageTimes* times) const {
  check(frame);
  check(prior, frame);
  return detect(
             frame, std::nullopt, [&](const Frame&) { return prior; }, trace, times)
      .people;
}

std::vector<Person> Detector::detect(const Frame& frame, Trace* trace, StageTimes* times) const {
  return detect(frame, Prior{}, trace, times);
}

FrameLabels Detector::label(const Frame& given, const Mask* person) const {
  check(given);
  if (const int quarters = quarters_to_upright(given); quarters != 0) {
    const Mask inside = person != nullptr ? turned(*person, quarters) : Mask{};
    const FrameLabels found = label(turned(given, quarters), person != nullptr ? &inside : nullptr);
    return {turned(found.labels, 4 - quarters), turned(found.inside, 4 - quarters)};
  }
  const std::optional<DepthImage> cleared = without_blended(given.depth, method_->options.blend);
  return on_grid(
      given, cleared ? *cleared : given.depth, method_->options.grid, nullptr,
      [&](const Frame& grid, int step) {
        const Mask inside = person != nullptr ? every_nth(*person, step) : Mask{};
        return label_everywhere(*method_, grid, person != nullptr ? &inside : nullptr);
      },
      [&](const GridGuide& guide, FrameLabels& labels) {
        labels.labels = guide.enlarge(labels.labels, kBackground);
        if (person != nullptr) labels.inside = guide.enlarge(labels.inside, kBackground);
      });
}

const BodyModel& Detector::body() const { return method_->body; }

std::shared_ptr<const Appearance> Detector::appearance() const { return method_->appearance; }

}  // namespace vesalius
