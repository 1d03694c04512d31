#pragma once

// Which way a person faces, decided from all of the person's pixels: a softmax regression over what the leaves'
// headings say part by part (leaf_logits.h). A single pixel often fits a left part seen from the front as well as a
// right one seen from behind; a whole body does not.

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "vesalius/forest.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"
#include "vesalius/person.h"

namespace vesalius {

/// Gathers what a person's pixels tell of the heading.
class FacingEvidence {
 public:
  FacingEvidence(int parts, int headings);

  /// Adds a pixel with its posteriors and P(side, heading | body) as in Posteriors. Pixels without a reading do not
  /// count.
  void add(const std::uint16_t* posteriors, const std::uint16_t* turns);
  /// Returns the features: for each part and heading the mean over its pixels of the heading's log probability above
  /// the mean of all headings; then the parts' shares of the pixels, and 1. Pixels count for a part by its posterior.
  /// All are 0 but the last if no pixel was added.
  Eigen::VectorXf features() const;

 private:
  int parts_, headings_;
  double pixels_ = 0.0;
  std::vector<double> logs_;    ///< [part][heading]
  std::vector<double> shares_;  ///< [part]
  std::vector<float> of_pixel_;
};

/// Returns the features of the person who covers the non-zero pixels of `person` inside `box`.
Eigen::VectorXf facing_features(const Posteriors& posteriors, int parts, const Mask& person, const Box& box);

/// Returns the probability of each heading; even ones without a model.
Eigen::VectorXf facing(const FacingModel& model, const Eigen::VectorXf& features);

/// Returns the mean direction of the likeliest heading and its two neighbours. `facing` is not empty.
YawEstimate estimate_yaw(const Eigen::VectorXf& facing);

/// Writes to `out` what the posteriors in `box` are for a person whose heading has the given probabilities, in a
/// picture of the box's size. The parts of each side together become as likely as the heading makes them; the
/// background stays.
void turn_posteriors(const Posteriors& posteriors, const std::vector<std::uint8_t>& sides,
                     const Eigen::VectorXf& facing, const Box& box, Posteriors& out);

}  // namespace vesalius
