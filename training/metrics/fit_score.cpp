#include "metrics/fit_score.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "metrics/fit_logistic.h"
#include "metrics/match_people.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

constexpr int kFeatures = static_cast<int>(kEvidenceWeights.size());
using Features = Eigen::Matrix<double, kFeatures, 1>;
using Weights = Eigen::Matrix<double, kFeatures + 1, 1>;  // the bias last

constexpr double kSmallestSpread = 0.1;  // of evidence; if values of few candidates hardly differ, they say nothing

Features features(const Evidence& e) {
  Features x;
  for (int i = 0; i < kFeatures; ++i) x[i] = static_cast<double>(e.*kEvidenceWeights[i].evidence);
  return x;
}

/// The overlap of a candidate with people, in units of what a match needs.
struct Likeness {
  double as_person = 0.0;  ///< IoU with one person, or the larger share for the mask of all people
  double on_people = 0.0;  ///< share of its pixels on people
};

Likeness likeness(const Mask& mask, const FrameTruth& truth, const DepthImage& depth) {
  std::array<long, 256> of_person{};
  std::array<long, 256> shared{};
  long pixels = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    const std::size_t who = !truth.person.empty() ? truth.person[i] : truth.mask[i] != 0 ? 0 : kBackground;
    ++of_person[who];
    if (mask[i] == 0) continue;
    ++shared[who];
    ++pixels;
  }
  if (pixels == 0) return {};
  const double on_people =
      static_cast<double>(pixels - shared[kBackground]) / static_cast<double>(pixels) / kShareOnMask;
  if (truth.person.empty()) {
    const double smaller = static_cast<double>(std::max(1L, std::min(pixels, of_person[0])));
    return {static_cast<double>(shared[0]) / smaller / kShareOnMask, on_people};
  }
  double best = 0.0;
  for (std::size_t who = 0; who < kBackground; ++who) {
    const auto either = static_cast<double>(of_person[who] + pixels - shared[who]);
    best = std::max(best, static_cast<double>(shared[who]) / either);
  }
  return {best / kMatchIou, on_people};
}

struct Weighted {
  Features x;
  bool person;
  double weight;
};

std::vector<Weighted> weighted(const std::vector<std::vector<ScoreSample>>& sets) {
  std::vector<Weighted> all;
  for (const std::vector<ScoreSample>& set : sets) {
    const auto people = static_cast<double>(std::ranges::count(set, true, &ScoreSample::person));
    const double nobodies = static_cast<double>(set.size()) - people;
    for (const ScoreSample& sample : set) {
      all.push_back({features(sample.evidence), sample.person, sample.person ? 1.0 / people : 1.0 / nobodies});
    }
  }
  return all;
}

/// Returns the share of the pairs of a person and a nobody in which the person's score is higher; equal scores count
/// half.
double area_under_curve(const std::vector<Weighted>& samples, const ScoreOptions& options) {
  std::vector<std::pair<float, bool>> scored;
  for (const Weighted& s : samples) {
    Evidence e;
    for (int i = 0; i < kFeatures; ++i) e.*kEvidenceWeights[i].evidence = static_cast<float>(s.x[i]);
    scored.emplace_back(person_score(e, options), s.person);
  }
  std::ranges::sort(scored);
  double pairs = 0.0, nobodies = 0.0, people = 0.0;
  for (std::size_t i = 0; i < scored.size();) {
    double equal_people = 0.0, equal_nobodies = 0.0;
    for (const float score = scored[i].first; i < scored.size() && scored[i].first == score; ++i) {
      (scored[i].second ? equal_people : equal_nobodies) += 1.0;
    }
    pairs += equal_people * (nobodies + 0.5 * equal_nobodies);
    nobodies += equal_nobodies;
    people += equal_people;
  }
  return pairs / (people * nobodies);
}

Weights logistic_weights(const std::vector<Weighted>& samples) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd features(kFeatures, count);
  Eigen::VectorXd positive(count), weight(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Weighted& sample = samples[static_cast<std::size_t>(i)];
    features.col(i) = sample.x;
    positive[i] = sample.person ? 1.0 : 0.0;
    weight[i] = sample.weight;
  }
  const LogisticFit fit = fit_logistic(features, positive, weight, kSmallestSpread);
  Weights w;
  w << fit.weights, fit.bias;
  return w;
}

/// Fits weights of which none contradicts what its evidence means: as long as some do, the largest of them is left out
/// and the others are fitted anew.
Weights plausible_weights(std::vector<Weighted> samples) {
  while (true) {
    const Weights w = logistic_weights(samples);
    int worst = -1;
    double most = 0.0;
    for (int i = 0; i < kFeatures; ++i) {
      const double against = -kEvidenceWeights[i].sign * w[i];
      if (against <= most) continue;
      most = against;
      worst = i;
    }
    if (worst < 0) return w;
    for (Weighted& s : samples) s.x[worst] = 0.0;
  }
}

}  // namespace

std::vector<ScoreSample> score_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth) {
  std::vector<ScoreSample> samples;
  const bool known = !truth.person.empty() || !truth.mask.empty();
  if (truth.people != 0 && !known) return samples;
  for (const Trace::Candidate& candidate : trace.candidates) {
    if (candidate.refined.found == 0) continue;
    const Likeness like = truth.people == 0 ? Likeness{} : likeness(candidate.grown, truth, depth);
    const bool person = like.as_person >= 1.0;
    if (person || std::max(like.as_person, like.on_people) < 0.5) samples.push_back({candidate.evidence, person});
  }
  return samples;
}

ScoreFit fit_score(const std::vector<std::vector<ScoreSample>>& sets, const ScoreOptions& start) {
  const std::vector<Weighted> samples = weighted(sets);
  ScoreFit fit;
  fit.options = start;
  fit.people = std::ranges::count(samples, true, &Weighted::person);
  fit.nobodies = static_cast<long>(samples.size()) - fit.people;
  if (fit.people == 0) throw Error("fitting the score: the frames have no candidate that is known to be a person");
  if (fit.nobodies == 0) throw Error("fitting the score: the frames have no candidate that is known to be nobody");
  const Weights w = plausible_weights(samples);
  for (int i = 0; i < kFeatures; ++i) {
    fit.options.*kEvidenceWeights[i].weight = static_cast<float>(w[i]);
  }
  fit.options.bias = static_cast<float>(w[kFeatures]);
  fit.area_before = area_under_curve(samples, start);
  fit.area_after = area_under_curve(samples, fit.options);
  return fit;
}

}  // namespace vesalius
