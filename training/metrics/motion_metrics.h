#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "metrics/frame_truth.h"
#include "metrics/metric_table.h"
#include "vesalius/derive_joints.h"

namespace vesalius {

/// A bone between two joints, on the left and on the right.
struct LimbBone {
  const char* from;
  const char* to;
};
inline constexpr std::array kLimbBones{LimbBone{"shoulder", "elbow"}, LimbBone{"elbow", "wrist"},
                                       LimbBone{"hip", "knee"}, LimbBone{"knee", "ankle"}};
/// Lengths in metres of those of the left, then of those of the right; NaN where one is not known.
using BoneLengths = std::array<double, 2 * kLimbBones.size()>;

/// Returns the lengths between joints of these names.
BoneLengths bone_lengths(const std::vector<std::string>& names, const std::vector<Eigen::Vector3f>& joints);
/// Returns the lengths between joints that were found, each bone's from the set called `preferred` or else the first
/// that has both ends. `joints` is [joint set][joint].
BoneLengths bone_lengths(const BodyModel& body, const std::string& preferred,
                         const std::vector<std::vector<Joint>>& joints);

/// A frame of one true person.
struct MotionStep {
  std::size_t frame = 0;  ///< index in the sequence
  double time_s = 0.0;
  std::vector<Eigen::Vector3f> truth;  ///< joints, metres, in a frame of axes that keeps still; NaN = not known
  std::vector<Eigen::Vector3f> found;  ///< the same joints as found, NaN = not found
  BoneLengths true_bones_m{}, found_bones_m{};
  int id = 0;         ///< id of the person whose joints were found; 0 = nobody's were
  int track_age = 0;  ///< frames since this id was first there, from 0
};
/// One true person over a sequence, by frame.
using PersonMotion = std::vector<MotionStep>;

/// Frames of a track after which its bones should have their lengths.
inline constexpr int kSettledFrames = 30;

/// Adds to the frames of a sequence, [frame], what its true people have in the metrics of motion:
///
/// - joints.jitter: the mean length of the second difference of a joint's places in three consecutive frames over the
///   square of the time between two, mm/s^2, where it was found in all three under one id; joints.true_jitter: the same
///   of the truth, of the same joints in the same frames.
/// - bones.error: |length found - true| / true, of the frames after the kSettledFrames-th of a track, the true length
///   being the median over the sequence; bones.spread: the standard deviation of a bone's length over these frames of a
///   track (at least kSettledFrames of them), over its true length.
///
/// Frames are consecutive where the time between them is within half of the usual one, the median of the sequence.
void add_motion_terms(const std::vector<PersonMotion>& people, std::vector<MetricTerms>& frames);

}  // namespace vesalius
