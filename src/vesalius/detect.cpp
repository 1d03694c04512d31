#include "vesalius/detect.h"

#include <algorithm>
#include <functional>
#include <limits>
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
#include "vesalius/find_clusters.h"
#include "vesalius/forest/facing.h"
#include "vesalius/grow_person.h"
#include "vesalius/known_people.h"
#include "vesalius/label_scene.h"
#include "vesalius/parallel.h"
#include "vesalius/predict_parts.h"
#include "vesalius/prior.h"
#include "vesalius/score_person.h"
#include "vesalius/search_skeletons.h"
#include "vesalius/trace.h"

namespace vesalius {

/// The data that all frames share, and memory that they reuse.
struct Method {
  /// `model` has a labeller.
  Method(Model model, const DetectOptions& given, std::shared_ptr<const Appearance> looks)
      : judge(
            in_order(model.judge.empty() ? default_judge() : model.judge, judge_names(model.body), "judge of people")),
        labeller(std::move(model), {given.label, given.smooth, given.grow.plane}),
        options(given),
        appearance(looks != nullptr ? std::move(looks) : make_appearance(given.grow.appearance)),
        body(labeller.body()) {}

  float score(const Evidence& evidence) const { return judge.probability(judge_features(evidence)); }

  BoostedTrees judge;  ///< asks for all evidence, in its order
  SceneLabeller labeller;
  DetectOptions options;
  std::shared_ptr<const Appearance> appearance;  ///< none if looks do not matter
  const BodyModel& body;
  mutable Pool<SceneLabels> memory;
};

namespace {

using Candidate = Trace::Candidate;

/// The result of the first pass on a frame.
struct Scene {
  SceneLabels labels;
  LabelImage proposals;  ///< labels with the proposals' weight of the background
  Clusters clusters;
  std::vector<Skeleton> rough;  ///< best first
};

/// Runs sections 4 to 6 on the whole picture.
Scene first_pass(const Method& method, const Frame& frame, StageClock& clock) {
  const DetectOptions& options = method.options;
  Scene scene;
  scene.labels = method.labeller.label_scene(frame, clock, method.memory.take());
  // Every pixel that may be a part is proposed as one. The score later separates people from the rest.
  scene.proposals = method.labeller.choose(scene.labels, frame, options.label.proposal_weight);
  clock.lap(Stage::choose);
  scene.clusters = find_clusters(scene.proposals, frame.depth, frame.camera, method.body, options.cluster);
  clock.lap(Stage::cluster);
  scene.rough = search_skeletons(scene.clusters.items, method.body, options.search);
  clock.lap(Stage::search);
  return scene;
}

constexpr float kRivalLikelihood = 0.2F;  // per part: rough skeletons of at least this grow against each other

/// Returns how many of the rough skeletons, which come best first, grow against each other.
std::size_t count_rivals(const std::vector<Skeleton>& rough, const Method& method) {
  const float least = kRivalLikelihood * float(method.body.part_count());
  const auto first_weak = std::ranges::find_if(rough, [&](const Skeleton& s) { return s.score < least; });
  const auto strong = static_cast<std::size_t>(first_weak - rough.begin());
  return std::min(strong, static_cast<std::size_t>(method.options.refine.max_candidates));
}

/// Grows masks (section 7). Every rough skeleton grows alone; the likelier ones also grow against each other, which
/// separates people who touch. The second pass decides which result is better.
std::vector<Candidate> grow_rough(const Method& method, const Scene& scene, const PersonGrower& grower) {
  const std::size_t count =
      std::min(scene.rough.size(), static_cast<std::size_t>(method.options.refine.max_candidates));
  const std::size_t rivals = count_rivals(scene.rough, method);
  std::vector<Mask> against;
  if (rivals > 1) {
    against = grower.grow(std::vector<Skeleton>(scene.rough.begin(), scene.rough.begin() + rivals), scene.clusters);
  }
  std::vector<Mask> alone(count);
  parallel_for(int(count), [&](int i) { alone[i] = std::move(grower.grow({scene.rough[i]}, scene.clusters)[0]); });
  for (std::size_t i = 0; i < against.size(); ++i) {
    if (alone[i] == against[i]) alone[i] = {};
  }
  std::vector<Candidate> candidates;
  for (std::vector<Mask>* masks : {&against, &alone}) {
    for (std::size_t i = 0; i < masks->size(); ++i) {
      if ((*masks)[i].empty()) continue;
      Candidate& candidate = candidates.emplace_back();
      candidate.rough = scene.rough[i];
      candidate.grown = std::move((*masks)[i]);
    }
  }
  return candidates;
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
    return candidate;
  }
  candidate.labels = method.labeller.label_person(scene.labels, frame, known.mask, bounding_box(known.mask)).labels;
  const Clusters clusters =
      find_clusters(candidate.labels, frame.depth, frame.camera, method.body, method.options.cluster);
  std::vector<Skeleton> rough = search_skeletons(clusters.items, method.body, method.options.search, known.size);
  if (rough.empty()) return std::nullopt;
  candidate.rough = std::move(rough.front());
  candidate.grown = std::move(grower.grow({candidate.rough}, clusters, {known.appearance})[0]);
  return candidate;
}

/// Returns where nobody grows: on flat surfaces and where the background is sure enough.
Mask barred(const Method& method, const SceneLabels& labels) {
  Mask barred = labels.flat;
  const auto least = double(method.options.grow.least_body);
  const Posteriors& posteriors = labels.posteriors();
  const int parts = method.body.part_count();
  if (least == 0.0) return barred;
  parallel_ranges(posteriors.height, kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < posteriors.width; ++u) {
        const std::optional<double> share = body_share(posteriors, u, v, parts);
        if (share && *share < least) barred(u, v) = 1;
      }
    }
  });
  return barred;
}

std::vector<Candidate> propose(const Method& method, const Frame& frame, const Scene& scene, const Looks& looks) {
  if (scene.rough.empty()) return {};
  const Mask nobody = barred(method, scene.labels);
  return grow_rough(method, scene, PersonGrower(frame, nobody, method.body, method.options.grow, looks));
}

/// Returns the best skeleton of a candidate's labels, which are within `box`, or one without parts if there is none.
/// `size` is that of the person (search_skeletons).
Skeleton second_pass(const Method& method, const Frame& frame, const LabelImage& labels, const Box& box, float size) {
  ClusterOptions options = method.options.cluster;
  constexpr float scale = 0.5F;  // of the smallest area of a part: in the second pass all pixels are a person's
  options.min_area_cm2 *= scale;
  options.min_pixels = std::max(1, int(float(options.min_pixels) * scale));
  const Clusters clusters =
      find_clusters(crop(labels, box), crop(frame.depth, box), cropped(frame.camera, box), method.body, options);
  std::vector<Skeleton> found = search_skeletons(clusters.items, method.body, method.options.search, size);
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
    candidate.refined = second_pass(method, frame, person.labels, box, size);
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
  if (person.facing.size() > 0) candidate.yaw = estimate_yaw(person.facing);
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

Scenery look_around(const Method& method, const Frame& frame, const Scene& scene,
                    const std::vector<Candidate>& candidates) {
  Mask anybody(frame.camera.width, frame.camera.height, 0);
  for (const Candidate& candidate : candidates) {
    for (std::size_t i = 0; i < anybody.size(); ++i) anybody[i] |= candidate.grown[i];
  }
  return {scene.labels.flat, mean_body_outside(anybody, frame.depth, scene.labels.smooth, method.body.part_count()),
          int(scene.rough.size())};
}

/// Refines candidates, among all others whose masks are known so far.
void refine_all(const Method& method, const Frame& frame, const Scene& scene, const Scenery& scenery,
                const Prior& prior, std::span<Candidate> candidates) {
  parallel_for(int(candidates.size()), [&](int i) {
    candidates[i] = refine(method, frame, scene, scenery, prior, std::move(candidates[i]));
    candidates[i].certainty = certainty_of(candidates[i], prior);
  });
}

/// Returns the known people whom no candidate that would pass anyway covers.
std::vector<int> missed_people(const Method& method, const Prior& prior, const std::vector<Candidate>& candidates) {
  const RefineOptions& options = method.options.refine;
  std::vector<int> missed;
  for (std::size_t i = 0; i < prior.people.size(); ++i) {
    const Mask& mask = prior.people[i].mask;
    if (mask.empty()) continue;
    const bool found = std::ranges::any_of(candidates, [&](const Candidate& candidate) {
      return candidate.score >= options.min_score && candidate.refined.found >= options.min_parts &&
             shared_pixels(candidate.grown, mask) >= kSurelyKnown;
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
  long pixels = 0;
  long shared = 0;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    pixels += mask[i] != 0 ? 1 : 0;
    shared += mask[i] != 0 && taken[i] != 0 ? 1 : 0;
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
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (taken[i] != 0) person.mask[i] = 0;
    if (person.mask[i] == 0) person.labels[i] = kBackground;
  }
  person.box = bounding_box(person.mask);
  return person;
}

/// Returns whether a candidate is taken for somebody whose body is known, so that it needs no parts of its own.
bool is_followed(const Candidate& candidate, const Prior& prior) {
  if (candidate.known < 0) return false;
  const Prior::KnownPerson& known = prior.people[static_cast<std::size_t>(candidate.known)];
  return !known.flesh.empty() && known.odds > 1.F;
}

/// Returns those candidates that are people, and marks them as accepted. `candidates` are sorted by certainty. A
/// candidate that mostly repeats a more certain one is dropped; pixels that two share belong to the more certain one.
std::vector<Person> choose_people(const Method& method, const Frame& frame, const Prior& prior,
                                  std::vector<Candidate>& candidates) {
  const RefineOptions& options = method.options.refine;
  std::vector<Person> people;
  Mask taken(frame.camera.width, frame.camera.height, 0);
  for (Candidate& candidate : candidates) {
    const bool few = candidate.refined.found < options.min_parts && !is_followed(candidate, prior);
    if (candidate.certainty < options.min_score || few) continue;
    if (repeats(candidate.grown, taken, options.max_overlap)) continue;
    candidate.accepted = true;
    people.push_back(make_person(method.body, candidate, taken));
    for (std::size_t i = 0; i < taken.size(); ++i) taken[i] |= people.back().mask[i];
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

/// Runs the method on one frame of any size.
Detection detect_everywhere(const Method& method, const Frame& frame, const std::function<Prior()>& ask, Trace* trace,
                            const Mask& person, StageTimes* times) {
  StageClock clock(times);
  Scene scene = first_pass(method, frame, clock);
  Prior prior = ask();
  clock.skip();  // the time that others took
  const KnownPeople known(frame, scene.labels.flat, scene.labels.smooth, method.body.part_count(), prior);
  Looks looks;
  if (!scene.rough.empty() || !prior.people.empty()) looks = look_at(frame, method.appearance.get());
  std::vector<Candidate> candidates = propose(method, frame, scene, looks);
  parallel_for(int(candidates.size()), [&](int i) {
    candidates[i].known = known.shown_by(candidates[i].grown);
    known.correct(candidates[i].known, candidates[i].grown);
  });
  clock.lap(Stage::grow);
  refine_all(method, frame, scene, look_around(method, frame, scene, candidates), prior, candidates);
  add_known(method, frame, scene, looks, prior, candidates);
  clock.lap(Stage::second_pass);
  std::ranges::stable_sort(candidates,
                           [](const Candidate& a, const Candidate& b) { return a.certainty > b.certainty; });
  Detection found{choose_people(method, frame, prior, candidates), scene.labels.planes};
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

Detection Detector::detect(const Frame& given, const AskPrior& ask, Trace* trace, StageTimes* times) const {
  check(given);
  StageClock clock(times);
  Frame memory;
  const Frame& frame = without_blended(given, method_->options.blend, memory);
  clock.lap(Stage::grid);
  return on_grid(
      frame, method_->options.grid, times,
      [&](const Frame& grid, int step) {
        const bool has_person = trace != nullptr && trace->person != nullptr;
        const Mask person = has_person ? every_nth(*trace->person, step) : Mask{};
        const auto ask_on_grid = [&] {
          const Prior prior = ask(given);
          check(prior, given);
          return every_nth(prior, step);
        };
        return detect_everywhere(*method_, grid, ask_on_grid, trace, person, times);
      },
      [&](const GridGuide& guide, Detection& found) {
        for (Person& person : found.people) enlarge(guide, person);
        if (trace != nullptr) enlarge(guide, *trace);
      });
}

std::vector<Person> Detector::detect(const Frame& frame, const Prior& prior, Trace* trace, StageTimes* times) const {
  check(frame);
  check(prior, frame);
  return detect(
             frame, [&](const Frame&) { return prior; }, trace, times)
      .people;
}

std::vector<Person> Detector::detect(const Frame& frame, Trace* trace, StageTimes* times) const {
  return detect(frame, Prior{}, trace, times);
}

FrameLabels Detector::label(const Frame& given, const Mask* person) const {
  check(given);
  Frame memory;
  const Frame& frame = without_blended(given, method_->options.blend, memory);
  return on_grid(
      frame, method_->options.grid, nullptr,
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
