#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/fit/body_state.h"
#include "vesalius/fit/normal_equations.h"
#include "vesalius/fit/silhouette.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"
#include "vesalius/predict_parts.h"

namespace vesalius {

inline constexpr float kPointWeight = 0.2F;  ///< weight of a point, since neighbours err alike
inline constexpr float kMirrorCost = 3.F;    ///< squared deviations that a label on the wrong side costs

/// The bones whose surface belongs to each part, and its middle.
struct PartSurface {
  struct Stretch {
    int bone = -1;
    double from = 0.0, to = 1.0;  ///< along the bone; beyond its ends where `to` or `from` are those
    int side = 0;                 ///< 1: the left half of the bone, -1: the right one, 0: both
  };
  std::vector<std::vector<Stretch>> of_part;

  /// The mean of a part's surface in a body of mean shape at rest, as a point of one of its bones. A part of two bones
  /// has it where they meet, however they are bent.
  struct Middle {
    int bone = -1;
    double along = 0.0;              ///< 0 is the bone's head, 1 its tail
    std::array<double, 2> across{};  ///< from the middle of the flesh there, in its half widths
    Eigen::Matrix3Xd by_shape;       ///< its derivative by the shape, in the bone's frame, the bone's head left out
  };
  std::vector<Middle> middle_of_part;

  /// Returns nothing for parts without surface rules, and for rules of bones that the flesh lacks.
  PartSurface(const BodyModel& body, const FleshModel& flesh);
};

/// The level ground in the optical frame.
struct Ground {
  Eigen::Vector3d up{0.0, -1.0, 0.0};  ///< unit vector
  double height_m = 0.0;               ///< height of the camera above the ground

  double height_of(const Eigen::Vector3d& point) const { return height_m + up.dot(point); }
};

/// What is known of a body before its points are looked at.
struct ExpectedBody {
  std::optional<Ground> ground;                        ///< below which no flesh is, and on which most people stand
  std::optional<BodyState> pose;                       ///< where the person is expected in this frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< velocity of the trunk, metres a second
  int start = 0;                                       ///< which of kStarts is tried besides the pose; -1: none
  double loosened = 1.0;              ///< multiplies the standard deviations of following; grows with the time gone by
  Eigen::VectorXd shape;              ///< mean of the shape
  Eigen::MatrixXd shape_information;  ///< inverse of its covariance
};

/// Everything that a body is fitted to in one frame.
struct FitData {
  std::vector<PersonPoint> points;
  std::optional<Silhouette> silhouette;
  std::vector<std::optional<Eigen::Vector3d>> centres;  ///< [part] mean of its visible surface
  std::vector<KnownMiddle> middles;                     ///< [part], seen or hidden; empty: nobody votes
  ExpectedBody expected;
};

/// The sums of squares that a body's fit minimises.
class FitTerms {
 public:
  /// The stretch of a bone to which a point is taken to belong, and what its labels cost then.
  struct Assigned {
    PartSurface::Stretch stretch;
    double label_cost = 0.0;
  };

  FitTerms(const FleshModel& flesh, const BodyModel& body, const FitOptions& options);

  /// Returns for each point the stretch to which it most probably belongs, by its labels and its place.
  std::vector<Assigned> assign(const FitData& data, const std::vector<PlacedBone>& placed) const;

  /// Fills `equations` with the terms of a state for points that are assigned so.
  void evaluate_points(const FitData& data, const BodyState& state, const std::vector<Assigned>& assigned,
                       std::vector<PlacedBone>& placed, NormalEquations& equations) const;
  /// Fills `equations` with the terms of a state that count for a start: the parts' centres and the priors, without the
  /// expected pose. Parts are taken for their mirror partners if `mirrored`.
  void evaluate_centres(const FitData& data, const BodyState& state, bool mirrored, std::vector<PlacedBone>& placed,
                        NormalEquations& equations) const;

  /// Returns the squared deviations that an upright body costs which moves over the ground against its front: who walks
  /// walks forwards, while people sit down, lie down and fall backwards, too. It is no term of the descent, since the
  /// way from one facing to the other leads through poses that fit nothing.
  double walk_cost(const ExpectedBody& expected, const BodyState& state) const;

  /// How the points that were assigned to a bone lie to it.
  struct Support {
    int points = 0;       ///< all of them
    int on = 0;           ///< those that lie on it
    double misfit = 0.0;  ///< mean of the robust squared deviations of all
  };
  /// Returns this for each bone.
  std::vector<Support> support(const FitData& data, const std::vector<PlacedBone>& placed,
                               const std::vector<Assigned>& assigned) const;

  const PartSurface& surface() const { return surface_; }

  /// The middle of a part's surface, optical frame.
  struct PartPlace {
    int bone;
    Eigen::Vector3d middle;
    double half_m;              ///< the smaller half width of the flesh there
    Eigen::Matrix3Xd by_shape;  ///< derivative of the middle by the shape, optical frame, the bone's head left out
  };
  /// Returns this for a part that has a surface.
  PartPlace place_of(int part, const std::vector<PlacedBone>& placed) const;

 private:
  struct Hit;
  Hit hit(const PlacedBone& bone, int index, const PartSurface::Stretch& stretch, const Eigen::Vector3d& at) const;
  void add_points(const FitData& data, const std::vector<PlacedBone>& placed, const std::vector<Assigned>& assigned,
                  NormalEquations& equations) const;
  void add_priors(const ExpectedBody& expected, const BodyState& state, NormalEquations& equations) const;
  /// Pulls a part's place that is `off`; what is far off counts less.
  void add_pull(const PartPlace& place, const Eigen::Vector3d& off, double sigma_m, NormalEquations& equations) const;
  void add_centres(const FitData& data, const std::vector<PlacedBone>& placed, bool mirrored,
                   NormalEquations& equations) const;
  void add_middles(const FitData& data, const std::vector<PlacedBone>& placed, NormalEquations& equations) const;
  void add_outline(const FitData& data, const std::vector<PlacedBone>& placed, NormalEquations& equations) const;
  void add_ground(const Ground& ground, const std::vector<PlacedBone>& placed, NormalEquations& equations) const;
  void add_poses(const BodyState& state, NormalEquations& equations) const;
  void add_limits(const BodyState& state, NormalEquations& equations) const;
  void add_followed(const ExpectedBody& expected, const BodyState& state, NormalEquations& equations) const;

  const FleshModel& flesh_;
  const BodyModel& body_;
  const FitOptions& options_;
  PartSurface surface_;
  std::vector<int> feet_;  ///< bones
};

}  // namespace vesalius
