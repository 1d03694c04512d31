#include "metrics/track_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>

#include "vesalius/base/assign_pairs.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

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
  return terms;
}

}  // namespace vesalius
