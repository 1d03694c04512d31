#include "vesalius/fit/joint_trust.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "vesalius/base/logistic.h"
#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr const char* kTrust =
#include "flesh_trust.inc"
    ;

constexpr double kMostWeight = 1000.0;

JointTrust read_trust(const TomlReader& reader, const toml::table& table) {
  JointTrust trust;
  std::vector<std::string_view> keys{"bias"};
  for (const TrustSignal& signal : kTrustSignals) keys.push_back(signal.name);
  reader.expect_keys(table, keys);
  trust.bias = reader.number(table, "bias", -kMostWeight, kMostWeight);
  for (const TrustSignal& signal : kTrustSignals) {
    trust.weights.*signal.value = reader.number_or_zero(table, signal.name, -kMostWeight, kMostWeight);
  }
  return trust;
}

}  // namespace

float trusted(const JointTrust& trust, const TrustSignals& signals) {
  double logit = double(trust.bias);
  for (const TrustSignal& signal : kTrustSignals) {
    logit += double(trust.weights.*signal.value) * double(signals.*signal.value);
  }
  return float(logistic(logit));
}

float trusted(const BodyTrust& trust, JointSource source, const TrustSignals& signals) {
  return trusted(trust.*kJointSources[static_cast<std::size_t>(source)].trust, signals);
}

float score_log_odds(float score) {
  constexpr float kMost = 4.F;
  const float odds = score / (1.F - score);
  return odds > 0.F ? std::clamp(std::log(odds), -kMost, kMost) : -kMost;
}

TrustSignals between(const TrustSignals& from, const TrustSignals& to, float along) {
  TrustSignals point;
  for (const TrustSignal& signal : kTrustSignals) {
    point.*signal.value = (1.F - along) * (from.*signal.value) + along * (to.*signal.value);
  }
  return point;
}

BodyTrust parse_body_trust(std::string_view toml, const std::string& source) {
  const TomlReader reader(source);
  const toml::table root = reader.parse(toml);
  reader.expect_keys(root, {"observed", "predicted", "hidden"});
  BodyTrust trust;
  for (const NamedSource& of : kJointSources) {
    trust.*of.trust = read_trust(reader, reader.table(reader.need(root, of.name), of.name));
  }
  return trust;
}

const BodyTrust& builtin_trust() {
  static const BodyTrust trust = parse_body_trust(kTrust, "flesh_trust");
  return trust;
}

}  // namespace vesalius
