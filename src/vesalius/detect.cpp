#include "vesalius/detect.h"

#include <algorithm>
#include <array>
#include <optional>

#include "vesalius/base/parallel.h"
#include "vesalius/workspaces.h"

namespace vesalius {
namespace {

DepthImage without(const DepthImage& depth, const Mask& mask) {
  DepthImage out = depth;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (mask[i] != 0) out[i] = 0;
  }
  return out;
}

/// Depth of the mask's pixels inside the box; the rest counts as far.
DepthImage keep_only(const DepthImage& depth, const Mask& mask, const Box& box) {
  DepthImage out = crop(depth, box);
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      if (mask(box.u + u, box.v + v) == 0) out(u, v) = 0;
    }
  }
  return out;
}

Camera cropped(Camera camera, const Box& box) {
  camera.width = box.width;
  camera.height = box.height;
  camera.cx -= static_cast<float>(box.u);
  camera.cy -= static_cast<float>(box.v);
  return camera;
}

/// `part` of a picture put back at its place in one of the frame's size.
LabelImage uncropped(const LabelImage& part, const Box& box, int width, int height) {
  LabelImage out(width, height, kBackground);
  for (int v = 0; v < box.height; ++v) std::copy_n(part.row(v), box.width, out.row(box.v + v) + box.u);
  return out;
}

/// The method on one frame, stage after stage.
class Pipeline {
 public:
  using Candidate = Trace::Candidate;

  Pipeline(const PixelLabeller& labeller, const DetectOptions& options, const Frame& frame,
           Workspaces::Workspace& workspace, StageTimes* times)
      : clock_(times),
        workspace_(workspace),
        labeller_(labeller),
        body_(labeller.body()),
        options_(options),
        frame_(frame) {}

  std::vector<Person> run(Trace* trace) {
    first_pass(trace);
    std::vector<Candidate> candidates = grow_candidates();
    clock_.lap(Stage::grow);
    parallel_for(static_cast<int>(candidates.size()), [&](int i) { refine(candidates[i]); });
    clock_.lap(Stage::second_pass);
    std::ranges::stable_sort(candidates, [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    std::vector<Person> people = choose_people(candidates);
    clock_.lap(Stage::people);
    if (trace != nullptr) {
      trace->clusters = std::move(clusters_);
      trace->rough = std::move(rough_);
      trace->flat = grower_->flat();
      trace->candidates = std::move(candidates);
    }
    return people;
  }

 private:
  const ScoreOptions& score_options() const {
    return labeller_.has_background() ? options_.score : options_.score_without_background;
  }

  bool by_mode() const { return options_.smooth.mode || !labeller_.has_distributions(); }

  /// Of pass 1, smoothed unless labels are.
  const Posteriors& posteriors() const { return by_mode() ? workspace_.raw : workspace_.smooth; }

  LabelImage choose(const Posteriors& posteriors, const DepthImage& depth, const LabelOptions& options,
                    const Mask* prior = nullptr, const Box* box = nullptr) const {
    const LabelChoice choice{body_.part_count(), labeller_.has_background(), prior, box};
    LabelImage labels = choose_labels(posteriors, depth, choice, options);
    return by_mode() ? mode_filter(labels, depth, options_.smooth) : labels;
  }

  void find_planes() { grower_.emplace(frame_, body_, options_.grow); }
  void label(const DepthImage& depth) { labeller_.label_into(depth, frame_.camera, options_.label, workspace_.raw); }

  /// Sections 4 to 6 on the whole scene. A forest that never saw a background takes walls and floor for bodies: it
  /// is shown the scene without them. Others need not wait for the planes.
  void first_pass(Trace* trace) {
    DepthImage without_planes;
    if (labeller_.has_background()) {
      std::array<double, 2> took_ms{};
      parallel_for(2, [&](int i) { took_ms[i] = elapsed_ms([&] { i == 0 ? find_planes() : label(frame_.depth); }); });
      clock_.lap({Stage::planes, Stage::label}, took_ms);
    } else {
      find_planes();
      clock_.lap(Stage::planes);
      without_planes = without(frame_.depth, grower_->flat());
      label(without_planes);
      clock_.lap(Stage::label);
    }
    const DepthImage& depth = labeller_.has_background() ? frame_.depth : without_planes;
    Posteriors& raw = workspace_.raw;
    if (trace != nullptr) {
      const LabelChoice choice{body_.part_count(), labeller_.has_background(), nullptr};
      trace->raw_labels = choose_labels(raw, depth, choice, options_.label);
    }
    if (!by_mode()) mean_filter(raw, depth, frame_.camera, options_.smooth, workspace_.smooth);
    clock_.lap(Stage::smooth);
    // What may be a part is taken for one; the score of the whole tells people from what is none.
    LabelOptions propose = options_.label;
    propose.background_weight = options_.label.proposal_weight;
    proposals_ = choose(posteriors(), depth, propose);
    if (trace != nullptr) trace->labels = choose(posteriors(), depth, options_.label);
    clock_.lap(Stage::choose);
    clusters_ = find_clusters(proposals_, depth, frame_.camera, body_, options_.cluster);
    clock_.lap(Stage::cluster);
    rough_ = search_skeletons(clusters_.items, body_, options_.search);
    clock_.lap(Stage::search);
  }

  /// Section 7. Every rough skeleton grows alone; the likelier ones also against each other, which keeps people apart
  /// who touch. Which of the two was right, the second pass tells.
  std::vector<Candidate> grow_candidates() const {
    std::vector<Candidate> candidates;
    const auto count = std::min(rough_.size(), static_cast<std::size_t>(options_.refine.max_candidates));
    std::vector<Skeleton> rivals;
    for (std::size_t i = 0; i < count; ++i) {  // best first, so rivals are the first ones
      if (rough_[i].score < options_.refine.rival_likelihood * static_cast<float>(body_.part_count())) break;
      rivals.push_back(rough_[i]);
    }
    if (rivals.size() > 1) {
      for (Mask& mask : grower_->grow(rivals, clusters_)) {
        candidates.push_back(make_candidate(static_cast<int>(candidates.size()), std::move(mask)));
      }
    }
    std::vector<Mask> alone(count);
    parallel_for(static_cast<int>(count),
                 [&](int i) { alone[i] = std::move(grower_->grow({rough_[i]}, clusters_)[0]); });
    const std::size_t against = candidates.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (i < against && candidates[i].grown == alone[i]) continue;
      candidates.push_back(make_candidate(static_cast<int>(i), std::move(alone[i])));
    }
    return candidates;
  }

  static Candidate make_candidate(int rough, Mask mask) {
    Candidate candidate;
    candidate.rough = rough;
    candidate.grown = std::move(mask);
    return candidate;
  }

  /// Second iteration: the same stages on one person, and the better of its two skeletons.
  void refine(Candidate& candidate) const {
    const Skeleton& rough = rough_[candidate.rough];
    const Box box = bounding_box(candidate.grown);
    if (box.width == 0) return;
    if (options_.refine.second_pass) {
      second_pass(box, candidate);
    } else {
      candidate.labels = proposals_;
    }
    if (candidate.refined.found == 0 || candidate.refined.score < rough.score) candidate.refined = rough;
    candidate.evidence = gather_evidence(frame_, candidate.grown, candidate.labels, posteriors(), candidate.refined,
                                         body_, score_options());
    candidate.score = person_score(candidate.evidence, score_options());
  }

  void second_pass(const Box& box, Candidate& candidate) const {
    ClusterOptions cluster = options_.cluster;
    cluster.min_area_cm2 *= options_.refine.area_scale;
    cluster.min_pixels =
        std::max(1, static_cast<int>(static_cast<float>(cluster.min_pixels) * options_.refine.area_scale));
    Clusters clusters;
    if (labeller_.has_background()) {
      // Its own label already tells what is no person: keep the scene, take the mask as what is known now.
      candidate.labels = choose(posteriors(), frame_.depth, options_.label, &candidate.grown, &box);
      clusters = find_clusters(crop(candidate.labels, box), crop(frame_.depth, box), cropped(frame_.camera, box), body_,
                               cluster);
    } else {
      const DepthImage alone = keep_only(frame_.depth, candidate.grown, box);
      const Camera camera = cropped(frame_.camera, box);
      Posteriors posteriors;
      labeller_.label_into(alone, camera, options_.label, posteriors);
      if (!by_mode()) posteriors = mean_filter(posteriors, alone, camera, options_.smooth);
      const LabelImage labels = choose(posteriors, alone, options_.label);
      clusters = find_clusters(labels, alone, camera, body_, cluster);
      candidate.labels = uncropped(labels, box, frame_.camera.width, frame_.camera.height);
    }
    std::vector<Skeleton> found = search_skeletons(clusters.items, body_, options_.search);
    if (!found.empty()) candidate.refined = std::move(found.front());
  }

  /// Surest first; who mostly repeats a surer one is dropped, shared pixels stay with the surer.
  std::vector<Person> choose_people(std::vector<Candidate>& candidates) const {
    std::vector<Person> people;
    Mask taken(frame_.camera.width, frame_.camera.height, 0);
    for (Candidate& candidate : candidates) {
      if (candidate.score < options_.refine.min_score || candidate.refined.found < options_.refine.min_parts) continue;
      long pixels = 0;
      long shared = 0;
      for (std::size_t i = 0; i < taken.size(); ++i) {
        pixels += candidate.grown[i] != 0 ? 1 : 0;
        shared += candidate.grown[i] != 0 && taken[i] != 0 ? 1 : 0;
      }
      if (static_cast<float>(shared) > options_.refine.max_overlap * static_cast<float>(pixels)) continue;
      candidate.accepted = true;
      people.push_back(make_person(candidate, taken));
      for (std::size_t i = 0; i < taken.size(); ++i) taken[i] |= people.back().mask[i];
    }
    return people;
  }

  Person make_person(const Candidate& candidate, const Mask& taken) const {
    Person person;
    person.skeleton = candidate.refined;
    predict_missing_parts(body_, person.skeleton);
    person.joints = derive_joints(body_, person.skeleton);
    person.score = candidate.score;
    person.mask = candidate.grown;
    person.labels = candidate.labels;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      if (taken[i] != 0) person.mask[i] = 0;
      if (person.mask[i] == 0) person.labels[i] = kBackground;
    }
    person.box = bounding_box(person.mask);
    return person;
  }

  StageClock clock_;
  Workspaces::Workspace& workspace_;
  const PixelLabeller& labeller_;
  const BodyModel& body_;
  const DetectOptions& options_;
  const Frame& frame_;
  std::optional<PersonGrower> grower_;  ///< once the planes are known
  LabelImage proposals_;                ///< pass 1, of what may be a part
  Clusters clusters_;                   ///< pass 1
  std::vector<Skeleton> rough_;
};

void enlarge(const GridGuide& guide, Person& person) {
  person.mask = guide.enlarge(person.mask, std::uint8_t{0}, person.box);
  person.labels = guide.enlarge(person.labels, kBackground, person.box);
  person.box = bounding_box(person.mask);
}

void enlarge(const GridGuide& guide, int width, int step, Trace& trace) {
  const int coarse_width = trace.labels.width();
  trace.raw_labels = guide.enlarge(trace.raw_labels, kBackground);
  trace.labels = guide.enlarge(trace.labels, kBackground);
  trace.flat = guide.enlarge(trace.flat, std::uint8_t{0});
  trace.clusters.index = guide.enlarge(trace.clusters.index, -1);
  for (PartCluster& cluster : trace.clusters.items) {
    cluster.first_pixel = cluster.first_pixel / coarse_width * step * width + cluster.first_pixel % coarse_width * step;
  }
  for (Trace::Candidate& candidate : trace.candidates) {
    candidate.grown = guide.enlarge(candidate.grown, std::uint8_t{0});
    candidate.labels = guide.enlarge(candidate.labels, kBackground);
  }
}

}  // namespace

Detector::Detector(Forest forest, DetectOptions options)
    : Detector(std::make_shared<ForestLabeller>(std::move(forest)), options) {}

Detector::Detector(std::shared_ptr<const PixelLabeller> labeller, DetectOptions options)
    : labeller_(std::move(labeller)), options_(options), workspaces_(std::make_shared<Workspaces>()) {
  RangeCheck check;
  visit_options("", options_, check);
}

std::vector<Person> Detector::detect(const Frame& frame, Trace* trace, StageTimes* times) const {
  check(frame);
  const int step = grid_step(frame.camera, options_.grid);
  if (step == 1) return detect_everywhere(frame, trace, times);
  StageClock before(times);
  const Frame coarse = every_nth(frame, step);
  before.lap(Stage::grid);
  std::vector<Person> people = detect_everywhere(coarse, trace, times);
  StageClock after(times);
  const GridGuide guide(frame.depth, step);
  for (Person& person : people) enlarge(guide, person);
  after.lap(Stage::grid);
  if (trace != nullptr) enlarge(guide, frame.depth.width(), step, *trace);
  return people;
}

std::vector<Person> Detector::detect_everywhere(const Frame& frame, Trace* trace, StageTimes* times) const {
  std::unique_ptr<Workspaces::Workspace> workspace = workspaces_->take();
  std::vector<Person> people = Pipeline(*labeller_, options_, frame, *workspace, times).run(trace);
  workspaces_->give_back(std::move(workspace));
  return people;
}

Image<std::uint8_t> body_index_map(const std::vector<Person>& people, int width, int height) {
  Image<std::uint8_t> map(width, height, kBackground);
  for (std::size_t p = 0; p < people.size() && p < kBackground; ++p) {
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (people[p].mask[i] != 0) map[i] = static_cast<std::uint8_t>(p);
    }
  }
  return map;
}

LabelImage part_label_map(const std::vector<Person>& people, int width, int height) {
  LabelImage map(width, height, kBackground);
  for (const Person& person : people) {
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (person.mask[i] != 0) map[i] = person.labels[i];
    }
  }
  return map;
}

}  // namespace vesalius
