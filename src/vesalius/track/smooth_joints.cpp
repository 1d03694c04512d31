#include "vesalius/track/smooth_joints.h"

#include <numbers>

namespace vesalius {
namespace {

constexpr float kSpeedCutoff_hz = 1.F;  // of the low pass of the velocity, as its authors have it

/// Returns the share of a new value that a low pass takes over.
float share(float cutoff_hz, float passed_s) {
  const float delay_s = 1.F / (2.F * std::numbers::pi_v<float> * cutoff_hz);
  return passed_s / (passed_s + delay_s);
}

}  // namespace

std::vector<std::vector<Joint>> JointSmoother::smooth(const std::vector<std::vector<Joint>>& joints, double passed_s,
                                                      const JointSmoothing& options) {
  const auto step_s = float(passed_s);
  std::vector<std::vector<Joint>> smoothed = joints;
  filters_.resize(joints.size());
  for (std::size_t set = 0; set < joints.size(); ++set) {
    filters_[set].resize(joints[set].size());
    for (std::size_t j = 0; j < joints[set].size(); ++j) {
      const Joint& joint = joints[set][j];
      Filter& filter = filters_[set][j];
      if (joint.state == State::none || !joint.position.allFinite()) {
        filter = {};
        continue;
      }
      if (!filter.known) {
        filter = {true, joint.position, Eigen::Vector3f::Zero(), joint.position};
      } else if (step_s > 0.F) {
        const Eigen::Vector3f velocity = (joint.position - filter.raw) / step_s;
        filter.velocity += share(kSpeedCutoff_hz, step_s) * (velocity - filter.velocity);
        const float cutoff = options.cutoff_hz + options.cutoff_per_m_s * filter.velocity.norm();
        filter.position += share(cutoff, step_s) * (joint.position - filter.position);
        filter.raw = joint.position;
      }
      smoothed[set][j].position = filter.position;
    }
  }
  return smoothed;
}

}  // namespace vesalius
