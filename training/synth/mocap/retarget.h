#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/mocap/motion.h"
#include "synth/pose/movement.h"
#include "synth/pose/pose.h"

namespace vesalius::synth {

/// How a bone's direction in the rest pose of a motion file relates to the T of `Pose`.
enum class RestRule : std::uint8_t {
  same,  ///< same direction: the joint's rotation is the bone's
  aim,   ///< other direction: the smallest turn from the T's direction to the joint's own is applied first
  like   ///< the turn of another bone is applied first
};

/// The source of one bone's rotation.
struct BoneSource {
  std::vector<std::string> from;  ///< one joint, or two if the rotation is half way between them
  RestRule rest = RestRule::same;
  Bone like = Bone::pelvis;  ///< the other bone of RestRule::like; that bone's rule is same or aim
};

/// The mapping from joints of one family of motion files to bones of a pose. The mappings are data; see data/rigs.
struct MotionConvention {
  std::string name;
  int skip_frames = 0;  ///< frames at the start that were not recorded (a T pose)
  std::array<BoneSource, kBoneCount> bones;
};

/// Parses a mapping from TOML. Throws Error naming line and expectation. Every bone must be there.
MotionConvention parse_convention(std::string_view toml, const std::string& name);

/// Returns the conventions that come with the program: asf_amc, cmu_bvh, daz_bvh.
const std::vector<MotionConvention>& builtin_conventions();

/// Returns the first convention whose joints the motion has. Throws Error naming the motion if none fits.
const MotionConvention& find_convention(const Motion& motion, const std::vector<MotionConvention>& conventions);

/// Returns the pose of every frame except the first `skip_frames`. The heading of the pelvis is removed. Throws Error
/// if motion and convention do not fit.
std::vector<Pose> retarget(const Motion& motion, const MotionConvention& convention);

/// Returns the same poses with the headings of the pelvis, continuous from frame to frame, and the ways of the root
/// over the floor in lengths of the motion's own legs. Throws Error if motion and convention do not fit, the legs have
/// no length, or no frame is left.
Movement retarget_movement(const Motion& motion, const MotionConvention& convention);

}  // namespace vesalius::synth
