#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/people_options.h"
#include "vesalius/person.h"

namespace vesalius {

/// Smooths the joints of one person over time by the One-Euro filter (Casiez, Roussel and Vogel 2012): a low pass whose
/// cutoff rises with the speed, so that joints at rest do not tremble and fast ones are not late. A joint that moves
/// evenly lags behind by 1 / (2 pi cutoff) seconds: 80 ms of its way as it begins to move, 20 ms at a metre a second.
class JointSmoother {
 public:
  /// Takes the joints of a frame, [set][joint], `passed_s` seconds after those before, and returns them smoothed. A
  /// joint without a place has none there either, and begins anew when it is back.
  std::vector<std::vector<Joint>> smooth(const std::vector<std::vector<Joint>>& joints, double passed_s,
                                         const JointSmoothing& options);

 private:
  struct Filter {
    bool known = false;
    Eigen::Vector3f position = Eigen::Vector3f::Zero();
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();
    Eigen::Vector3f raw = Eigen::Vector3f::Zero();
  };

  std::vector<std::vector<Filter>> filters_;
};

}  // namespace vesalius
