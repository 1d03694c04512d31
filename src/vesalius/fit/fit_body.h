#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/fit/body_state.h"
#include "vesalius/fit/fit_terms.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/person.h"

namespace vesalius {

/// Ways to begin a fit from the kinematic skeleton: as it is and mirrored, with the two most usual poses of each limb.
inline constexpr int kStarts = 4;

/// A fitted body as the fit knows it, from which the next frame's fit starts.
struct BodyFit {
  FittedBody body;
  BodyState state;
  /// Whether it was found without the expected pose and shape, which do not fit what is seen.
  bool restarted = false;
  Eigen::MatrixXd shape_information;  ///< what this frame's points tell of the shape, without what was known before
};

/// Fits bodies to people: an articulated body of flesh whose parts lie on the points with their labels, which has no
/// flesh where the camera sees free space, in a usual pose and of a usual shape. Levenberg-Marquardt from several
/// starts: the kinematic skeleton, its mirror image, and the body of the last frame; the best fit wins, so that facing
/// and crossed limbs are decided by the whole body. It may be used from several threads.
class BodyFitter {
 public:
  /// Throws UsageError for an option outside its range. `flesh` and `trust` must outlive it.
  explicit BodyFitter(BodyModel body, FitOptions options = {}, const FleshModel& flesh = builtin_flesh(),
                      const BodyTrust& trust = builtin_trust());
  // Its terms refer to its body model and options.
  BodyFitter(const BodyFitter&) = delete;
  BodyFitter& operator=(const BodyFitter&) = delete;

  /// Returns whether the body model has surface rules of the flesh's bones, without which nothing is fitted.
  bool can_fit() const { return can_fit_; }

  /// Returns the body of a person, or nothing if too little of the person is known. `expected` is what earlier frames
  /// tell (its shape may be empty). The frame's size is the mask's.
  std::optional<BodyFit> fit(const Frame& frame, const Person& person, const ExpectedBody& expected = {}) const;

  /// Returns whether the expected body moves against its front, so that it may face the wrong way.
  bool walks_backwards(const ExpectedBody& expected) const;
  /// Sets the shape to what is known of anybody's.
  void forget_shape(ExpectedBody& expected) const;

  const FleshModel& flesh() const { return flesh_; }
  const BodyTrust& trust() const { return trust_; }
  const BodyModel& body() const { return body_; }

 private:
  struct Solution;
  using Evaluate = std::function<void(const BodyState&, std::vector<PlacedBone>&, NormalEquations&)>;
  Solution descend(BodyState start, int steps, const Evaluate& evaluate) const;
  Solution fit_points(const FitData& data, BodyState start, int rounds) const;
  std::optional<Solution> fit_afresh(const FitData& data, int first, int count) const;
  double cost(const FitData& data, const Solution& solution) const;
  double cost_anew(const FitData& data, const Solution& solution) const;
  std::optional<BodyState> first_state(const FitData& data, bool mirrored, std::size_t pose) const;
  BodyFit report(const FitData& data, float score, const Solution& solution) const;

  BodyModel body_;
  FitOptions options_;
  const FleshModel& flesh_;
  const BodyTrust& trust_;
  FitTerms terms_;
  bool can_fit_ = false;
};

}  // namespace vesalius
