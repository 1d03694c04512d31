#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "metrics/frame_truth.h"
#include "vesalius/body_model.h"
#include "vesalius/detect.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/person.h"
#include "vesalius/trace.h"

namespace vesalius {

/// What is known of a case, and whether the answer was yes.
struct BoostSample {
  std::vector<float> features;
  bool positive = false;
};

/// A person who was found, with the truth about that person. Places are in metres, optical frame; NaN = not known.
struct KnownPerson {
  Skeleton skeleton;                          ///< what was given out, with predicted parts
  std::string joint_set;                      ///< the only set that is compared with the joints; empty means any
  std::vector<std::string> joint_names;       ///< names of `joints`
  std::vector<Eigen::Vector3f> joints;        ///< in the order of joint_names
  std::vector<Eigen::Vector3f> part_centres;  ///< [part] centre of the part's volume; empty if not known
};

/// A joint that was given out by a fitted body, and whether it was right.
struct TrustSample {
  JointSource source = JointSource::observed;
  TrustSignals signals;
  bool right = false;  ///< within kJointTolerance_m of the truth
};

/// The posture of somebody in a frame, and the true stance.
struct StanceSample {
  Posture posture;
  Stance stance = Stance::unknown;  ///< standing, sitting or lying
};

/// Returns one of every kContextEvery cells of a frame that may be bodies (body_context.h), as the detector sees them,
/// and whether they are. `model` has a labeller. Frames whose labels are not known have none. The same
/// frame gives the same cells.
std::vector<BoostSample> context_samples(const TrueFrame& frame, const Model& model, const DetectOptions& options);
inline constexpr unsigned kContextEvery = 48;

/// Adds a sample for each joint of a person that comes from the fitted body (builtin_flesh_joints) and whose truth is
/// known. `names` and `truth` (metres, optical frame; NaN = not known) have one order; the places are those of
/// found.person.joints.
void add_trust_samples(const TrackedPerson& found, const std::vector<JointSet>& sets, const JointSet& set,
                       const std::vector<std::string>& names, const std::vector<Eigen::Vector3f>& truth,
                       std::vector<TrustSample>& samples);

/// Returns the evidence (judge_features) for the candidates of a frame of which the truth tells whether they are
/// people. Each is judged by itself, however many show the same person. A candidate is a person if its mask has an IoU
/// of at least kMatchIou with a true one. Where only the mask of all people is known, kShareOnMask of its pixels must
/// lie there, or that share of the mask on it. A candidate is nobody if it has less than half of this and less than
/// half of kShareOnMask on people, or if the frame is empty. All others are left out, and so are frames with people of
/// whose masks nothing is known.
std::vector<BoostSample> judge_samples(const Trace& trace, const FrameTruth& truth, const DepthImage& depth);

}  // namespace vesalius
