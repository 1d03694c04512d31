#pragma once

#include <Eigen/Core>
#include <optional>

#include "vesalius/fit/fit_body.h"
#include "vesalius/person.h"

namespace vesalius {

/// What is learned of one person's body over frames: the last pose and, with growing certainty, the person's own shape
/// (section 9: matching the model to a person).
class BodyHistory {
 public:
  /// Fits the person's body in the next frame, at `time_s` seconds, and learns from it. Returns nothing if too little
  /// of the person is known; then nothing is learned either. `ground` is where the floor is, if that is known;
  /// `velocity` is that of the person's trunk, metres a second, optical frame.
  std::optional<FittedBody> fit(const BodyFitter& fitter, const Frame& frame, const Person& person, double time_s,
                                const std::optional<Ground>& ground = {},
                                const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero());

  /// Returns the body that is expected at `time_s`: it moves on as it did, but not deeper into the floor than it was in
  /// the last frame. Nothing if the pose is not known any more. `flesh` is what the body was fitted with.
  std::optional<BodyState> expected_state(const FleshModel& flesh, double time_s) const;

  /// Forgets the pose and keeps the shape, as for somebody who comes back.
  void forget_pose() { last_.reset(); }
  /// Returns the height of the person standing upright, metres, if anything was learned yet.
  std::optional<float> stature_m() const { return stature_m_; }
  /// Returns how tall the person is against the flesh model's mean body, by what all frames together tell. Nothing
  /// before kSettledFrames frames have told it.
  std::optional<float> size() const { return learned_ < kSettledFrames ? std::nullopt : size_; }
  static constexpr int kSettledFrames = 30;
  int frames() const { return frames_; }

 private:
  ExpectedBody expect(const BodyFitter& fitter, double time_s, const std::optional<Ground>& ground,
                      const Eigen::Vector3d& velocity) const;
  void learn(const FleshModel& flesh, const BodyFit& fit, const ExpectedBody& expected);

  struct Last {
    BodyState state;
    Eigen::Vector3d velocity;              ///< velocity of the root in metres a second
    std::vector<Eigen::Vector3d> turning;  ///< turning of each bone about its own axes in radians a second
    std::optional<Ground> ground;
    double time_s;
  };
  std::optional<Last> last_;
  Eigen::VectorXd shape_;        ///< mean; empty before the first frame
  Eigen::MatrixXd information_;  ///< inverse covariance of the shape
  std::optional<float> stature_m_;
  float misfit_ = 0.F;  ///< misfit of the last body
  int frames_ = 0;
  int learned_ = 0;  ///< frames that told something of the shape
  std::optional<float> size_;
};

}  // namespace vesalius
