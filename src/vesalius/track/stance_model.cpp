#include "vesalius/track/stance_model.h"

#include <vector>

#include "vesalius/base/logistic.h"
#include "vesalius/base/toml_reader.h"

namespace vesalius {
namespace {

constexpr const char* kStances =
#include "stances.inc"
    ;

constexpr double kMostStanceWeight = 1000.0;
constexpr float kUsual_m = 1.7F;  // stature of people without a fitted body
constexpr float kBent_m = 0.7F;   // no bed is as high as hips that are higher: whose are bends over

std::string unknown_key(const StanceSign& sign) { return "no_" + std::string(sign.name); }

StanceRule read_rule(const TomlReader& reader, const toml::table& table) {
  StanceRule rule;
  std::vector<std::string> keys{"bias"};
  for (const StanceSign& sign : kStanceSigns) keys.insert(keys.end(), {std::string(sign.name), unknown_key(sign)});
  reader.expect_keys(table, keys);
  rule.bias = reader.number(table, "bias", -kMostStanceWeight, kMostStanceWeight);
  for (std::size_t i = 0; i < kStanceSigns.size(); ++i) {
    const StanceSign& sign = kStanceSigns[i];
    rule.weights[i] = reader.number_or_zero(table, sign.name, -kMostStanceWeight, kMostStanceWeight);
    rule.unknown[i] = reader.number_or_zero(table, unknown_key(sign), -kMostStanceWeight, kMostStanceWeight);
  }
  return rule;
}

}  // namespace

std::optional<float> value_of(const StanceSign& sign, const Posture& posture) {
  const std::optional<float> value = posture.*sign.value;
  if (!value || !sign.metres) return value;
  return *value / posture.stature_m.value_or(kUsual_m);
}

float StanceRule::probability(const Posture& posture) const {
  double logit = double(bias);
  for (std::size_t i = 0; i < kStanceSigns.size(); ++i) {
    const std::optional<float> value = value_of(kStanceSigns[i], posture);
    logit += double(value ? weights[i] * *value : unknown[i]);
  }
  return float(logistic(logit));
}

StanceProbabilities stance_probabilities(const StanceModel& model, const Posture& posture) {
  StanceProbabilities of;
  if (!posture.hips_m || *posture.hips_m <= kBent_m) of.lying = model.lying.probability(posture);
  // Without the floor nobody knows who stands and who sits, nor without hips whether somebody small does.
  const bool clear = posture.chest_m && (posture.stature_m || posture.hips_m);
  const float standing = clear ? model.standing.probability(posture) : 0.5F;
  of.standing = (1.F - of.lying) * standing;
  of.sitting = (1.F - of.lying) * (1.F - standing);
  return of;
}

StanceModel parse_stance_model(std::string_view toml, const std::string& source) {
  const TomlReader reader(source);
  const toml::table root = reader.parse(toml);
  StanceModel model;
  reader.expect_keys(root, {"lying", "standing"});
  for (const NamedRule& of : kStanceRules) {
    model.*of.rule = read_rule(reader, reader.table(reader.need(root, of.name), of.name));
  }
  return model;
}

const StanceModel& builtin_stances() {
  static const StanceModel model = parse_stance_model(kStances, "stances");
  return model;
}

}  // namespace vesalius
