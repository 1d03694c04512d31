#pragma once

namespace vesalius {

/// By how much joints err differently as seen from different sides, metres, whatever their confidence.
inline constexpr float kJointBias_m = 0.03F;

/// Returns the standard deviation along each axis, metres, of a joint that lies within 10 cm of the truth with this
/// probability, 0-1, if its errors are normal and alike in all directions.
float sigma_of(float confidence);

/// Returns the probability of a joint of this standard deviation: the inverse of sigma_of.
float confidence_of(float sigma_m);

}  // namespace vesalius
