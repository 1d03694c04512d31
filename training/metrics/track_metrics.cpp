#include "metrics/track_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <set>
#include <string>

#include "metrics/frame_truth.h"
#include "metrics/match_people.h"
#include "metrics/pixel_metrics.h"
#include "vesalius/base/assign_pairs.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Least similarity at which a found person can be a true one (CLEAR MOT, IDF1).
constexpr double kTrackSimilarity = 0.5;
/// How similar two people are by their trunks: 1 at one place, falling to 0 at this distance in metres.
constexpr double kTrunkReach_m = 1.0;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr int kThresholds = 19;

double threshold_of(int place) { return 0.05 * (place + 1); }

double count(const std::vector<int>& ids) { return double(ids.size()); }

/// Indices of a sequence's ids, in the order of the ids.
class IdIndex {
 public:
  IdIndex(const std::vector<TrackSample>& sequence, std::vector<int> TrackSample::*ids) {
    for (const TrackSample& sample : sequence) {
      for (const int id : sample.*ids) index_.try_emplace(id, 0);
    }
    int next = 0;
    for (auto& [id, index] : index_) index = next++;
  }

  int size() const { return int(index_.size()); }
  int of(int id) const { return index_.at(id); }

 private:
  std::map<int, int> index_;
};

/// CLEAR MOT of a sequence, frame by frame.
class ClearMot {
 public:
  void add(const TrackSample& sample, std::size_t frame, MetricTerms& terms) {
    const std::vector<int> match = matcher_.match(sample);
    double matched = 0.0, switches = 0.0;
    for (std::size_t t = 0; t < match.size(); ++t) {
      Person& person = people_.try_emplace(sample.truth[t], Person{frame}).first->second;
      if (match[t] < 0) continue;
      const int id = sample.found[match[t]];
      matched += 1.0;
      if (!person.ids.empty() && person.last != id) switches += 1.0;
      if (person.ids.insert(id).second) terms.push_back({Metric::track_ids, 1.0, 0.0});
      person.last = id;
    }
    const double truth = count(sample.truth), wrong = count(sample.found) - matched;
    terms.push_back({Metric::track_mota, matched - wrong - switches, truth});
    terms.push_back({Metric::track_missed, truth - matched, truth});
    terms.push_back({Metric::track_false, wrong, 1.0});
    terms.push_back({Metric::track_switches, switches, 0.0});
  }

  /// Adds what is said of each true person to the frame in which it is first.
  void finish(std::vector<MetricTerms>& terms) const {
    for (const auto& [id, person] : people_) {
      for (const Metric metric : {Metric::track_switches, Metric::track_ids}) {
        terms[person.first].push_back({metric, 0.0, 1.0});
      }
    }
  }

 private:
  /// A true person so far.
  struct Person {
    std::size_t first = 0;  ///< its first frame
    std::set<int> ids = {};
    int last = 0;  ///< the id that it was found with last
  };

  TrackMatcher matcher_;
  std::map<int, Person> people_;
};

/// The numbers of frames that true and found ids share.
struct SharedFrames {
  Eigen::MatrixXd both;  ///< [true id][found id]
  Eigen::VectorXd of_truth, of_found;

  SharedFrames(int truth, int found)
      : both(Eigen::MatrixXd::Zero(truth, found)),
        of_truth(Eigen::VectorXd::Zero(truth)),
        of_found(Eigen::VectorXd::Zero(found)) {}
};

/// Calls `use(true person, found person, index of the true id, of the found id)` for all pairs of a frame.
template <class Use>
void for_pairs(const TrackSample& sample, const IdIndex& truth, const IdIndex& found, const Use& use) {
  for (std::size_t t = 0; t < sample.truth.size(); ++t) {
    for (std::size_t f = 0; f < sample.found.size(); ++f) {
      use(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(f), truth.of(sample.truth[t]),
          found.of(sample.found[f]));
    }
  }
}

void add_identity(const std::vector<TrackSample>& sequence, std::vector<MetricTerms>& terms) {
  const IdIndex truth(sequence, &TrackSample::truth), found(sequence, &TrackSample::found);
  Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(truth.size(), found.size());
  for (const TrackSample& sample : sequence) {
    for_pairs(sample, truth, found, [&](Eigen::Index t, Eigen::Index f, int true_id, int found_id) {
      if (sample.similarity(t, f) >= kTrackSimilarity - kEpsilon) shared(true_id, found_id) += 1.0;
    });
  }
  const std::vector<int> found_of = assign_pairs(-shared);
  for (std::size_t frame = 0; frame < sequence.size(); ++frame) {
    const TrackSample& sample = sequence[frame];
    double right = 0.0;
    for_pairs(sample, truth, found, [&](Eigen::Index t, Eigen::Index f, int true_id, int found_id) {
      if (found_of[true_id] == found_id && sample.similarity(t, f) >= kTrackSimilarity - kEpsilon) right += 1.0;
    });
    terms[frame].push_back({Metric::track_idf1, 2.0 * right, count(sample.truth) + count(sample.found)});
  }
}

/// HOTA of a sequence: one match of each frame for all thresholds, by similarity and by how well ids agree over all.
class Hota {
 public:
  explicit Hota(const std::vector<TrackSample>& sequence)
      : sequence_(sequence), truth_(sequence, &TrackSample::truth), found_(sequence, &TrackSample::found) {
    const Eigen::MatrixXd agreement = ids_agree();
    for (const TrackSample& sample : sequence_) {
      Eigen::MatrixXd cost = sample.similarity;
      for_pairs(sample, truth_, found_, [&](Eigen::Index t, Eigen::Index f, int true_id, int found_id) {
        cost(t, f) *= -agreement(true_id, found_id);
      });
      matches_.push_back(assign_pairs(cost));
    }
  }

  void add(int place, std::vector<MetricTerms>& terms) const {
    const double threshold = threshold_of(place);
    SharedFrames shared(truth_.size(), found_.size());
    for (std::size_t frame = 0; frame < sequence_.size(); ++frame) {
      for (const int id : sequence_[frame].truth) shared.of_truth[truth_.of(id)] += 1.0;
      for (const int id : sequence_[frame].found) shared.of_found[found_.of(id)] += 1.0;
      for_matches(frame, threshold, [&](int true_id, int found_id) { shared.both(true_id, found_id) += 1.0; });
    }
    const std::string parameter = fmt::format("{:.2f}", threshold);
    const auto id = [&](Metric metric) { return MetricId(metric, place, parameter); };
    for (std::size_t frame = 0; frame < sequence_.size(); ++frame) {
      double matched = 0.0, associated = 0.0;
      for_matches(frame, threshold, [&](int true_id, int found_id) {
        const double both = shared.both(true_id, found_id);
        matched += 1.0;
        associated += both / (shared.of_truth[true_id] + shared.of_found[found_id] - both);
      });
      const double all = count(sequence_[frame].truth) + count(sequence_[frame].found) - matched;
      terms[frame].push_back({id(Metric::track_det_a_at), matched, all});
      terms[frame].push_back({id(Metric::track_ass_a_at), associated, matched});
    }
  }

 private:
  /// Returns for each pair of ids the share of their frames in which they are the same person, each frame weighted by
  /// how much more similar they are than others.
  Eigen::MatrixXd ids_agree() const {
    SharedFrames shared(truth_.size(), found_.size());
    for (const TrackSample& sample : sequence_) {
      for (const int id : sample.truth) shared.of_truth[truth_.of(id)] += 1.0;
      for (const int id : sample.found) shared.of_found[found_.of(id)] += 1.0;
      const Eigen::VectorXd of_truth = sample.similarity.rowwise().sum();
      const Eigen::RowVectorXd of_found = sample.similarity.colwise().sum();
      for_pairs(sample, truth_, found_, [&](Eigen::Index t, Eigen::Index f, int true_id, int found_id) {
        const double similar = sample.similarity(t, f);
        const double either = of_truth[t] + of_found[f] - similar;
        if (either > kEpsilon) shared.both(true_id, found_id) += similar / either;
      });
    }
    for (Eigen::Index t = 0; t < shared.both.rows(); ++t) {
      for (Eigen::Index f = 0; f < shared.both.cols(); ++f) {
        shared.both(t, f) /= shared.of_truth[t] + shared.of_found[f] - shared.both(t, f);
      }
    }
    return shared.both;
  }

  template <class Use>
  void for_matches(std::size_t frame, double threshold, const Use& use) const {
    const TrackSample& sample = sequence_[frame];
    for (std::size_t t = 0; t < sample.truth.size(); ++t) {
      const int f = matches_[frame][t];
      if (f < 0) continue;
      if (sample.similarity(static_cast<Eigen::Index>(t), f) < threshold - kEpsilon) continue;
      use(truth_.of(sample.truth[t]), found_.of(sample.found[f]));
    }
  }

  const std::vector<TrackSample>& sequence_;
  IdIndex truth_, found_;
  std::vector<std::vector<int>> matches_;  ///< [frame][true person]
};

void check(const TrackSample& sample) {
  const Eigen::MatrixXd& similarity = sample.similarity;
  if (similarity.rows() != static_cast<Eigen::Index>(sample.truth.size()) ||
      similarity.cols() != static_cast<Eigen::Index>(sample.found.size())) {
    throw Error(fmt::format("similarity of tracks: {}x{}, expected {} true and {} found people", similarity.rows(),
                            similarity.cols(), sample.truth.size(), sample.found.size()));
  }
  if (similarity.size() > 0 &&
      !(similarity.minCoeff() >= 0.0 && similarity.maxCoeff() <= 1.0 && similarity.allFinite())) {
    throw Error("similarity of tracks: expected numbers from 0 to 1");
  }
}

constexpr std::array kTrunkWords{"shoulder", "hip", "spine", "torso", "pelvis"};

bool is_of_trunk(const std::string& joint) {
  return std::ranges::any_of(kTrunkWords, [&](const char* word) { return joint.find(word) != std::string::npos; });
}

std::optional<Eigen::Vector3f> known_mean(const std::vector<Eigen::Vector3f>& points) {
  if (std::ranges::all_of(points, [](const auto& point) { return point.hasNaN(); })) return std::nullopt;
  return mean_known(points);
}

/// Returns the middle of a true person's trunk: the mean of the joints of shoulders, hips, spine and trunk that are
/// known, or of all joints, or of the parts; nothing if none is known.
std::optional<Eigen::Vector3f> true_trunk(const FrameTruth& truth, std::size_t person) {
  if (person < truth.joints.size()) {
    std::vector<Eigen::Vector3f> trunk;
    for (std::size_t j = 0; j < truth.joint_names.size(); ++j) {
      if (is_of_trunk(truth.joint_names[j])) trunk.push_back(truth.joints[person][j]);
    }
    if (auto mean = known_mean(trunk)) return mean;
    if (auto mean = known_mean(truth.joints[person])) return mean;
  }
  return person < truth.parts.size() ? known_mean(truth.parts[person]) : std::nullopt;
}

/// What the similarity of a true and a found person is made of, in a frame.
enum class SimilarityKind {
  masks,   ///< IoU of masks: the pixels of each true person are known
  trunks,  ///< distance of trunks (kTrunkReach_m): joints or parts are known, but no pixels
  counts,  ///< 1 for everybody who is where people are, as far as is known (match_people); otherwise 0
};

SimilarityKind similarity_kind(const FrameTruth& truth) {
  if (!truth.person.empty()) return SimilarityKind::masks;
  return truth.joints.empty() && truth.parts.empty() ? SimilarityKind::counts : SimilarityKind::trunks;
}

double trunk_similarity(const FrameTruth& truth, std::size_t person, const TrackedPerson& found) {
  const auto trunk = true_trunk(truth, person);
  if (!trunk || !found.position.allFinite()) return 0.0;
  return std::max(0.0, 1.0 - double((*trunk - found.position).norm()) / kTrunkReach_m);
}

/// Returns what is known of one found person by itself.
Match::Kind alone(const TrackedPerson& found, const TrueFrame& frame) {
  const Proposal proposal{&found.person.mask, &found.person.skeleton, found.person.score};
  return match_people({proposal}, frame.truth, frame.frame.depth).front().kind;
}

/// The pixels with a reading of each true person.
std::vector<Mask> masks_of(const FrameTruth& truth, std::size_t people) {
  std::vector<Mask> masks(people, Mask(truth.person.width(), truth.person.height(), 0));
  for (std::size_t i = 0; i < truth.person.size(); ++i) {
    if (truth.person[i] < people) masks[truth.person[i]][i] = 1;
  }
  return masks;
}

bool is_blank(const Mask& mask) {
  return std::ranges::all_of(mask, [](std::uint8_t pixel) { return pixel == 0; });
}

void fill_similarity(const TrueFrame& frame, TrackPeople& people) {
  const FrameTruth& truth = frame.truth;
  const SimilarityKind kind = similarity_kind(truth);
  const auto most = std::ranges::max_element(people.truth);
  const std::size_t persons = most == people.truth.end() ? 0 : *most + 1;
  const std::vector<Mask> masks = kind == SimilarityKind::masks ? masks_of(truth, persons) : std::vector<Mask>{};
  people.sample.similarity.resize(static_cast<Eigen::Index>(people.truth.size()),
                                  static_cast<Eigen::Index>(people.found.size()));
  for (std::size_t t = 0; t < people.truth.size(); ++t) {
    for (std::size_t f = 0; f < people.found.size(); ++f) {
      const TrackedPerson& found = *people.found[f];
      const std::size_t who = people.truth[t];
      double similarity = 0.0;
      if (kind == SimilarityKind::masks && has_pixels(found) && !is_blank(masks[who])) {
        similarity = mask_iou(found.person.mask, masks[who], frame.frame.depth);
      } else if (kind == SimilarityKind::counts && has_pixels(found)) {
        similarity = alone(found, frame) == Match::Kind::person ? 1.0 : 0.0;
      } else if (kind != SimilarityKind::counts) {
        similarity = trunk_similarity(truth, who, found);
      }
      people.sample.similarity(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(f)) = similarity;
    }
  }
}

/// Returns the found people with pixels who are right or false, and with `hidden` all others who are not lost.
std::vector<const TrackedPerson*> taking_part(const TrueFrame& frame, const TrackedFrame& tracked, bool hidden) {
  std::vector<const TrackedPerson*> visible, people;
  for (const TrackedPerson& person : tracked.people) {
    if (person.state == TrackState::lost) continue;
    if (has_pixels(person)) visible.push_back(&person);
    if (hidden && !has_pixels(person)) people.push_back(&person);
  }
  // Only where each true person's pixels are known can all be told from nobody.
  const bool all_count = hidden && similarity_kind(frame.truth) == SimilarityKind::masks;
  std::ranges::stable_sort(visible, std::ranges::greater{}, [](const auto* person) { return person->person.score; });
  std::vector<Proposal> proposals;
  proposals.reserve(visible.size());
  for (const TrackedPerson* person : visible) {
    proposals.push_back({&person->person.mask, &person->person.skeleton, person->person.score});
  }
  const std::vector<Match> matches = match_people(proposals, frame.truth, frame.frame.depth);
  for (std::size_t i = 0; i < visible.size(); ++i) {
    if (all_count || matches[i].kind != Match::Kind::ignored) people.push_back(visible[i]);
  }
  std::ranges::sort(people, {}, &TrackedPerson::id);
  return people;
}

}  // namespace

std::vector<int> TrackMatcher::match(const TrackSample& sample) {
  check(sample);
  std::vector<int> match(sample.truth.size(), -1);
  std::vector<bool> taken(sample.found.size(), false);
  const auto fits = [&](std::size_t t, std::size_t f) {
    const double similar = sample.similarity(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(f));
    return similar >= kTrackSimilarity - kEpsilon;
  };
  for (std::size_t t = 0; t < match.size(); ++t) {
    const auto last = last_.find(sample.truth[t]);
    if (last == last_.end()) continue;
    const std::size_t f = std::ranges::find(sample.found, last->second) - sample.found.begin();
    if (f == taken.size() || taken[f] || !fits(t, f)) continue;
    match[t] = int(f);
    taken[f] = true;
  }
  // A pair that does not fit costs more than all that do.
  const double no_pair = 1.0 + double(std::max(match.size(), taken.size()));
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(sample.similarity.rows(), sample.similarity.cols(), no_pair);
  for (std::size_t t = 0; t < match.size(); ++t) {
    for (std::size_t f = 0; f < taken.size(); ++f) {
      const auto row = static_cast<Eigen::Index>(t), column = static_cast<Eigen::Index>(f);
      if (match[t] < 0 && !taken[f] && fits(t, f)) cost(row, column) = 1.0 - sample.similarity(row, column);
    }
  }
  const std::vector<int> pairs = assign_pairs(cost);
  for (std::size_t t = 0; t < match.size(); ++t) {
    if (match[t] < 0 && pairs[t] >= 0 && cost(static_cast<Eigen::Index>(t), pairs[t]) < no_pair) match[t] = pairs[t];
    if (match[t] >= 0) last_[sample.truth[t]] = sample.found[match[t]];
  }
  return match;
}

std::vector<MetricTerms> track_terms(const std::vector<TrackSample>& sequence) {
  std::vector<MetricTerms> terms(sequence.size());
  ClearMot clear;
  for (std::size_t frame = 0; frame < sequence.size(); ++frame) clear.add(sequence[frame], frame, terms[frame]);
  clear.finish(terms);
  add_identity(sequence, terms);
  const Hota hota(sequence);
  for (int place = 0; place < kThresholds; ++place) hota.add(place, terms);
  return terms;
}

bool has_pixels(const TrackedPerson& person) { return !is_blank(person.person.mask); }

std::optional<TrackPeople> track_people_of(const TrueFrame& frame, const TrackedFrame& tracked, bool hidden) {
  const FrameTruth& truth = frame.truth;
  const auto expected = static_cast<std::size_t>(expected_people(truth));
  if (truth.ids.size() < expected) return std::nullopt;
  TrackPeople people;
  const std::size_t count = hidden ? truth.ids.size() : expected;
  for (std::size_t who = 0; who < count; ++who) {
    people.truth.push_back(who);
    people.sample.truth.push_back(truth.ids[who]);
  }
  people.found = taking_part(frame, tracked, hidden);
  for (const TrackedPerson* person : people.found) people.sample.found.push_back(person->id);
  fill_similarity(frame, people);
  return people;
}

}  // namespace vesalius
