#include "learn/fit_tracks.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vesalius/base/logistic.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kLeastSpread = 0.01;  // of a feature; one that hardly ever changes says nothing
constexpr double kRidge = 1e-3;        // per unit of the samples' weight, on standardised features
constexpr int kMostSteps = 100;
constexpr double kSmallestStep = 1e-10;

JointTrust fitted(const std::vector<const TrustSample*>& samples) {
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd features(static_cast<Eigen::Index>(kTrustSignals.size()), count);
  Eigen::VectorXd right(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const TrustSample& sample = *samples[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < kTrustSignals.size(); ++k) {
      features(static_cast<Eigen::Index>(k), i) = double(sample.signals.*kTrustSignals[k].value);
    }
    right[i] = sample.right ? 1.0 : 0.0;
  }
  const LogisticFit fit = fit_logistic(features, right, Eigen::VectorXd::Ones(count));
  JointTrust trust;
  trust.bias = float(fit.bias);
  for (std::size_t k = 0; k < kTrustSignals.size(); ++k) {
    trust.weights.*kTrustSignals[k].value = float(fit.weights[static_cast<Eigen::Index>(k)]);
  }
  return trust;
}

double disagreement(const std::vector<const TrustSample*>& samples, const JointTrust& trust) {
  struct Tenth {
    double confidence = 0.0, right = 0.0;
  };
  std::array<Tenth, 10> tenths{};
  for (const TrustSample* sample : samples) {
    const float confidence = trusted(trust, sample->signals);
    Tenth& tenth = tenths[static_cast<std::size_t>(std::clamp(int(10.F * confidence), 0, 9))];
    tenth.confidence += double(confidence);
    tenth.right += sample->right ? 1.0 : 0.0;
  }
  double sum = 0.0;
  for (const Tenth& tenth : tenths) sum += std::abs(tenth.right - tenth.confidence);
  return samples.empty() ? 0.0 : sum / double(samples.size());
}

constexpr std::array kBeds_m{0.F, 0.25F, 0.5F};  // heights of what people lie on

Posture raised(Posture posture, float by_m) {
  for (std::optional<float>* height_m : {&posture.top_m, &posture.chest_m, &posture.hips_m}) {
    if (*height_m) **height_m += by_m;
  }
  return posture;
}

/// Returns the samples with those who lie higher, and all without heights over the floor.
std::vector<StanceSample> with_variants(const std::vector<StanceSample>& samples) {
  std::vector<StanceSample> all;
  for (const StanceSample& sample : samples) {
    for (const float by_m : kBeds_m) {
      all.push_back({raised(sample.posture, sample.stance == Stance::lying ? by_m : 0.F), sample.stance});
    }
    StanceSample& without_floor = all.emplace_back(sample);
    without_floor.posture.top_m = without_floor.posture.chest_m = without_floor.posture.hips_m = std::nullopt;
  }
  return all;
}

/// Fits a rule that tells `stance` from the others among the samples; each stance counts the same.
StanceRule fitted(const std::vector<StanceSample>& samples, Stance stance) {
  constexpr auto kSigns = static_cast<Eigen::Index>(kStanceSigns.size());
  const auto count = static_cast<Eigen::Index>(samples.size());
  std::array<double, 5> of_stance{};
  for (const StanceSample& sample : samples) of_stance[static_cast<std::size_t>(sample.stance)] += 1.0;
  Eigen::MatrixXd features = Eigen::MatrixXd::Zero(2 * kSigns, count);
  Eigen::VectorXd is(count), weight(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const StanceSample& sample = samples[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < kSigns; ++k) {
      const std::optional<float> value = value_of(kStanceSigns[static_cast<std::size_t>(k)], sample.posture);
      if (value) {
        features(k, i) = double(*value);
      } else {
        features(kSigns + k, i) = 1.0;
      }
    }
    is[i] = sample.stance == stance ? 1.0 : 0.0;
    weight[i] = 1.0 / of_stance[static_cast<std::size_t>(sample.stance)];
  }
  const LogisticFit fit = fit_logistic(features, is, weight);
  StanceRule rule;
  rule.bias = float(fit.bias);
  for (Eigen::Index k = 0; k < kSigns; ++k) {
    rule.weights[static_cast<std::size_t>(k)] = float(fit.weights[k]);
    rule.unknown[static_cast<std::size_t>(k)] = float(fit.weights[kSigns + k]);
  }
  return rule;
}

bool is_right(const StanceModel& model, const StanceSample& sample) {
  const StanceProbabilities of = stance_probabilities(model, sample.posture);
  const float own = sample.stance == Stance::standing  ? of.standing
                    : sample.stance == Stance::sitting ? of.sitting
                                                       : of.lying;
  return own > 1.F / 3.F && own >= std::max({of.standing, of.sitting, of.lying});
}

}  // namespace

LogisticFit fit_logistic(const Eigen::MatrixXd& features, const Eigen::VectorXd& positive,
                         const Eigen::VectorXd& weight) {
  const Eigen::Index count = features.rows(), samples = features.cols();
  const auto all = double(samples);
  const Eigen::VectorXd mean = features.rowwise().sum() / all;
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(count);
  for (Eigen::Index s = 0; s < samples; ++s) spread += (features.col(s) - mean).cwiseAbs2();
  spread = (spread / all).cwiseSqrt().cwiseMax(kLeastSpread);
  Eigen::MatrixXd standard(count, samples);
  for (Eigen::Index s = 0; s < samples; ++s) standard.col(s) = (features.col(s) - mean).cwiseQuotient(spread);
  LogisticFit fit = fit_standard_logistic(standard, positive, weight, kRidge * weight.sum());
  fit.weights = fit.weights.cwiseQuotient(spread).eval();
  fit.bias -= fit.weights.dot(mean);
  return fit;
}

LogisticFit fit_standard_logistic(const Eigen::MatrixXd& features, const Eigen::VectorXd& positive,
                                  const Eigen::VectorXd& weight, double ridge_on_weights) {
  const Eigen::Index count = features.rows(), samples = features.cols();
  Eigen::MatrixXd ridge = Eigen::MatrixXd::Zero(count + 1, count + 1);
  ridge.diagonal().head(count).setConstant(ridge_on_weights);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(count + 1), x(count + 1);  // the bias last
  x[count] = 1.0;
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::VectorXd slope = -(ridge * w);
    Eigen::MatrixXd curvature = ridge;
    for (Eigen::Index s = 0; s < samples; ++s) {
      x.head(count) = features.col(s);
      const double p = logistic(w.dot(x));
      slope += weight[s] * (positive[s] - p) * x;
      curvature.selfadjointView<Eigen::Lower>().rankUpdate(x, weight[s] * p * (1.0 - p));
    }
    const Eigen::VectorXd change = curvature.selfadjointView<Eigen::Lower>().ldlt().solve(slope);
    w += change;
    if (change.norm() < kSmallestStep) break;
  }
  return {w.head(count), w[count]};
}

TrustFit fit_trust(const std::vector<TrustSample>& samples, const BodyTrust& start) {
  TrustFit fit;
  fit.trust = start;
  bool any = false;
  for (std::size_t s = 0; s < kJointSources.size(); ++s) {
    std::vector<const TrustSample*> of_source;
    TrustAgreement& agreement = fit.agreement[s];
    for (const TrustSample& sample : samples) {
      if (sample.source != kJointSources[s].source) continue;
      of_source.push_back(&sample);
      ++agreement.samples;
      agreement.right += sample.right ? 1 : 0;
    }
    JointTrust& trust = fit.trust.*kJointSources[s].trust;
    agreement.before = disagreement(of_source, trust);
    if (std::min(agreement.right, agreement.samples - agreement.right) >= kLeastTrustSamples) {
      trust = fitted(of_source);
      agreement.fitted = any = true;
    }
    agreement.after = disagreement(of_source, trust);
  }
  if (!any) {
    throw Error(
        fmt::format("fitting the trust: expected fitted bodies with at least {} right and {} wrong joints of one kind",
                    kLeastTrustSamples, kLeastTrustSamples));
  }
  return fit;
}

StanceFit fit_stances(const std::vector<StanceSample>& samples, const StanceModel& start) {
  StanceFit fit;
  for (StanceAgreement& agreement : fit.agreement) {
    agreement.samples = std::ranges::count(samples, agreement.stance, &StanceSample::stance);
    if (agreement.samples >= kLeastStanceSamples) continue;
    throw Error(fmt::format("fitting the stances: {} people found {}, expected at least {}", agreement.samples,
                            to_string(agreement.stance), kLeastStanceSamples));
  }
  std::vector<StanceSample> all = with_variants(samples);
  fit.model.lying = fitted(all, Stance::lying);
  // Without the floor nobody knows who stands and who sits.
  std::erase_if(all, [](const StanceSample& s) { return s.stance == Stance::lying || !s.posture.chest_m; });
  fit.model.standing = fitted(all, Stance::standing);
  for (const StanceSample& sample : samples) {
    StanceAgreement& agreement = *std::ranges::find(fit.agreement, sample.stance, &StanceAgreement::stance);
    agreement.right_before += is_right(start, sample) ? 1 : 0;
    agreement.right_after += is_right(fit.model, sample) ? 1 : 0;
  }
  return fit;
}

}  // namespace vesalius
