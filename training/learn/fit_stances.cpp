#include "learn/fit_stances.h"

#include <fmt/format.h>

#include <algorithm>

#include "learn/fit_logistic.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kLeastSpread = 0.01;            // of a sign; one that hardly ever changes says nothing
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
  const LogisticFit fit = fit_logistic(features, is, weight, kLeastSpread);
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
