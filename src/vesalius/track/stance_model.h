#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "vesalius/person.h"

namespace vesalius {

/// What of a posture a rule looks at. Metres count in units of the person's stature, or of 1.7 m where that is not
/// known.
struct StanceSign {
  std::string_view name;  ///< name in files; with "no_" before it where it is not known
  std::optional<float> Posture::*value;
  bool metres = true;
};
inline constexpr std::array kStanceSigns{StanceSign{"top", &Posture::top_m},
                                         StanceSign{"chest", &Posture::chest_m},
                                         StanceSign{"hips", &Posture::hips_m},
                                         StanceSign{"pitch", &Posture::pitch_m},
                                         StanceSign{"vertical", &Posture::vertical_m},
                                         StanceSign{"trunk", &Posture::trunk_up, false},
                                         StanceSign{"thighs", &Posture::thighs_up, false}};

/// Returns the sign's value in a posture.
std::optional<float> value_of(const StanceSign& sign, const Posture& posture);

/// A logistic regression: the logit is the bias and, of each sign, its value times its weight, or the weight of not
/// being known.
struct StanceRule {
  float bias = 0.F;
  std::array<float, kStanceSigns.size()> weights{};  ///< [sign of kStanceSigns]
  std::array<float, kStanceSigns.size()> unknown{};

  /// Returns the probability that a posture is what the rule tells, 0-1.
  float probability(const Posture& posture) const;
};

/// How probable each stance is by one frame, where all are equally frequent.
struct StanceModel {
  StanceRule lying;     ///< lying rather than standing or sitting
  StanceRule standing;  ///< standing rather than sitting, for those who do not lie
};

struct NamedRule {
  std::string_view name;  ///< name in files
  StanceRule StanceModel::*rule;
};
inline constexpr std::array kStanceRules{NamedRule{"lying", &StanceModel::lying},
                                         NamedRule{"standing", &StanceModel::standing}};

/// The probabilities of the stances by one frame; they sum to 1.
struct StanceProbabilities {
  float standing = 0.F, sitting = 0.F, lying = 0.F;
};
StanceProbabilities stance_probabilities(const StanceModel& model, const Posture& posture);

/// Parses a model. Throws Error naming `source`, line and expectation.
StanceModel parse_stance_model(std::string_view toml, const std::string& source);

/// Returns the model that comes with the program (data/bodies/stances.toml).
const StanceModel& builtin_stances();

}  // namespace vesalius
