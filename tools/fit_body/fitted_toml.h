#pragma once

#include <string>
#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/track/stance_model.h"

namespace vesalius {

/// Returns as TOML the joint sets of the body that the people have joints of, fitted to them (fit_joint_sets). Throws
/// Error if there was nothing to fit.
std::string joints_toml(const std::vector<KnownPerson>& people, const BodyModel& body);

/// Returns the distribution of parts fitted to those people (fit_distribution) as TOML of a body model. Throws Error if
/// there are too few.
std::string parts_toml(const std::vector<KnownPerson>& people, const BodyModel& body);

/// Returns the text of data/bodies/flesh_trust.toml.
std::string trust_toml(const BodyTrust& fitted);

/// Returns the text of data/bodies/stances.toml.
std::string stances_toml(const StanceModel& fitted);

}  // namespace vesalius
