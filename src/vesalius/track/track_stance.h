#pragma once

#include <optional>
#include <utility>

#include "vesalius/base/body_model.h"
#include "vesalius/fit/fitted_body.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/search_skeletons.h"
#include "vesalius/track/tracked_frame.h"

namespace vesalius {

/// What one frame tells about how somebody holds the body.
struct Posture {
  float trunk_rad = 0.F;          ///< of the trunk's axis, from hips to chest and head, against up; 0 upright
  bool hips_seen = true;          ///< false where they are those of the fitted body
  std::optional<float> pelvis_m;  ///< height of the hips above the floor, if that is known
  std::optional<float> head_m;    ///< of the head, or of the neck or chest where the head is not seen
  bool head_seen = false;         ///< whether it is the head's
  std::optional<float> knee_m;    ///< height of the knees, if they are seen
};

/// Returns the posture of a person; nothing where `up` is not known, or the skeleton lacks seen hips, or a seen part of
/// the trunk or head above them. `up` is the unit vector away from the ground in the optical frame, `height_m` the
/// camera's over the floor, if that is known. `fitted_hips` is the middle of the hips by the fitted body, metres,
/// optical frame, where that is trusted; it stands in for hips that are not seen.
std::optional<Posture> posture_of(const Skeleton& skeleton, const BodyModel& body,
                                  const std::optional<Eigen::Vector3f>& up, std::optional<float> height_m,
                                  const std::optional<Eigen::Vector3f>& fitted_hips = {});

/// Returns where the parts of the hips have their middle by a fitted body, metres, optical frame, if that is rather
/// within 10 cm of the truth than not.
std::optional<Eigen::Vector3f> trusted_hips(const FittedBody& fitted, const FleshModel& flesh);

/// Follows how one person stands, sits, lies or falls. A stance holds from when it has been seen without contradiction
/// for some time, and then counts from the first frame in which it was seen. Whoever lies on the floor within 2 seconds
/// of being upright has fallen, and so has whoever lies there for 10 seconds; who lies as high as on a bed has not.
/// Nobody lies or falls by hips that are only fitted. Without evidence for 5 seconds the stance is unknown.
class TrackStance {
 public:
  /// Takes the posture of a frame, if there is one. Returns the new stance and when it began, if it changed.
  std::optional<std::pair<Stance, double>> update(const std::optional<Posture>& posture, double time_s);

  Stance stance() const { return stance_; }

 private:
  /// A stance that lasts, but not yet for long enough.
  struct Seen {
    Stance stance = Stance::unknown;
    double since_s = 0.0;
    int frames = 0;
  };

  std::optional<std::pair<Stance, double>> change(Stance stance, double since_s);

  Stance stance_ = Stance::unknown;
  Seen seen_;
  std::optional<double> upright_s_;  ///< when the person was last seen upright
  std::optional<double> known_s_;    ///< when there was evidence last
  bool fell_ = false;                ///< whether the person had been upright shortly before what is seen now
};

}  // namespace vesalius
