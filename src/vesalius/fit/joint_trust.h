#pragma once

#include <array>
#include <string>
#include <string_view>

#include "vesalius/person.h"

namespace vesalius {

/// A signal and its name in files.
struct TrustSignal {
  std::string_view name;
  float TrustSignals::*value;
};
inline constexpr std::array kTrustSignals{TrustSignal{"log_sigma", &TrustSignals::log_sigma},
                                          TrustSignal{"misfit", &TrustSignals::misfit},
                                          TrustSignal{"bone_misfit", &TrustSignals::bone_misfit},
                                          TrustSignal{"free", &TrustSignals::free},
                                          TrustSignal{"shape", &TrustSignals::shape},
                                          TrustSignal{"score", &TrustSignals::score},
                                          TrustSignal{"unseen", &TrustSignals::unseen_s}};

/// A logistic regression for the probability that a joint lies within 10 cm of the truth: the logit is the bias and the
/// sum of each signal times its weight.
struct JointTrust {
  float bias = 0.F;
  TrustSignals weights;
};

/// How the place of a fitted joint is known.
enum class JointSource {
  observed,   ///< the camera sees flesh about it
  predicted,  ///< it follows from the rest of the body
  hidden      ///< nobody was found in this frame, and the body is moved on from the last one
};

/// The trust in fitted joints of each source.
struct BodyTrust {
  JointTrust observed, predicted, hidden;
};

struct NamedSource {
  JointSource source;
  std::string_view name;  ///< name in files
  JointTrust BodyTrust::*trust;
};
inline constexpr std::array kJointSources{NamedSource{JointSource::observed, "observed", &BodyTrust::observed},
                                          NamedSource{JointSource::predicted, "predicted", &BodyTrust::predicted},
                                          NamedSource{JointSource::hidden, "hidden", &BodyTrust::hidden}};

/// Returns the probability that a joint lies within 10 cm of the truth, 0-1.
float trusted(const JointTrust& trust, const TrustSignals& signals);
float trusted(const BodyTrust& trust, JointSource source, const TrustSignals& signals);

/// Returns the log odds of a person's score, at most 4 to either side: a score of 0 or 1 is no more than very sure.
float score_log_odds(float score);

/// Returns the signals of a point between two others: `along` 0 is the first, 1 the second.
TrustSignals between(const TrustSignals& from, const TrustSignals& to, float along);

/// Parses a trust. Throws Error naming `source`, line and expectation.
BodyTrust parse_body_trust(std::string_view toml, const std::string& source);

/// Returns the trust that comes with the program (data/bodies/flesh_trust.toml).
const BodyTrust& builtin_trust();

/// Returns how the place of a bone of a body is known.
inline JointSource source_of(const FittedBody& body, const FittedBone& bone) {
  if (body.hidden) return JointSource::hidden;
  return bone.state == State::observed ? JointSource::observed : JointSource::predicted;
}

}  // namespace vesalius
