#include "learn/fit_trust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "learn/fit_logistic.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr double kLeastSpread = 0.01;  // of a signal; one that hardly ever changes says nothing

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
  const LogisticFit fit = fit_logistic(features, right, Eigen::VectorXd::Ones(count), kLeastSpread);
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

}  // namespace

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

}  // namespace vesalius
