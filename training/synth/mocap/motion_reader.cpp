#include "synth/mocap/motion_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "synth/mocap/amc.h"
#include "synth/mocap/bvh.h"
#include "synth/pose/joint_angles.h"
#include "vesalius/error.h"

namespace vesalius::synth {

Motion MotionReader::read(const MotionFile& file) {
  if (!file.path.ends_with(".amc") && !file.path.ends_with(".AMC")) return parse_bvh(read_(file.path), file.path);
  if (file.skeleton.empty()) {
    throw Error(fmt::format("{}: no skeleton: expected an .asf beside it with the beginning of its name", file.path));
  }
  return parse_amc(read_(file.path), file.path, skeleton(file.skeleton), file.fps);
}

const AsfSkeleton& MotionReader::skeleton(const std::string& path) {
  const auto found = skeletons_.find(path);
  if (found != skeletons_.end()) return found->second;
  return skeletons_.emplace(path, parse_asf(read_(path), path)).first->second;
}

std::size_t usual_step(float fps) {
  constexpr float kUsualFps = 30.F;
  return static_cast<std::size_t>(std::max(1L, std::lround(fps / kUsualFps)));
}

bool hands_twisted(const Pose& pose) {
  constexpr float kMost = 110.F;
  const auto twisted = [&](bool left) { return std::abs(arm_angles(pose, left).pronation) > kMost; };
  return twisted(true) || twisted(false);
}

}  // namespace vesalius::synth
