#include "synth/mocap/pose_library.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "synth/mocap/amc.h"
#include "synth/mocap/bvh.h"
#include "synth/mocap/retarget.h"
#include "synth/mocap/thin_poses.h"
#include "synth/pose/joint_angles.h"
#include "synth/pose/posture.h"
#include "synth/pose/self_contact.h"
#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

constexpr float kDegree = 3.14159265F / 180.F;
constexpr float kUsualFps = 30.F;  // frame rate to which faster recordings are reduced

/// Returns whether a hand is turned impossibly far. Forearm and wrist together turn a hand by about 90 degrees to
/// either side, but solvers of marker data sometimes lose the hand's turn and give any angle.
bool hands_twisted(const Pose& pose) {
  constexpr float kMost = 110.F;
  const auto twisted = [&](bool left) { return std::abs(arm_angles(pose, left).pronation) > kMost; };
  return twisted(true) || twisted(false);
}

/// Loads motions. A skeleton that several motions share is read once.
class MotionLoader {
 public:
  explicit MotionLoader(const ReadText& read) : read_(read) {}

  struct Recording {
    std::vector<Pose> poses;
    float fps = 0.F;
  };

  Recording load(const MotionFile& file) {
    const Motion motion = read(file);
    return {retarget(motion, find_convention(motion, builtin_conventions())), motion.fps};
  }

 private:
  Motion read(const MotionFile& file) {
    if (!file.path.ends_with(".amc") && !file.path.ends_with(".AMC")) return parse_bvh(read_(file.path), file.path);
    if (file.skeleton.empty()) {
      throw Error(fmt::format("{}: no skeleton: expected an .asf beside it with the beginning of its name", file.path));
    }
    return parse_amc(read_(file.path), file.path, skeleton(file.skeleton), file.fps);
  }

  const AsfSkeleton& skeleton(const std::string& path) {
    const auto found = skeletons_.find(path);
    if (found != skeletons_.end()) return found->second;
    return skeletons_.emplace(path, parse_asf(read_(path), path)).first->second;
  }

  const ReadText& read_;
  std::map<std::string, AsfSkeleton> skeletons_;
};

}  // namespace

void visit_options(const std::string& prefix, PoseLibraryOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "every", options.every, {"", 1, 1000, "Takes every so many frames of a recorded motion."});
  visitor.option(prefix + "min-angle", options.min_angle_deg,
                 {"deg", 0.0, 180.0, "Angle by which a pose must differ in some joint from every other one kept."});
}

std::vector<Pose> load_motion(const MotionFile& file, const ReadText& read) {
  return MotionLoader(read).load(file).poses;
}

PoseLibrary load_pose_library(std::span<const MotionFile> files, const ReadText& read,
                              const PoseLibraryOptions& options) {
  PoseLibraryOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);

  PoseLibrary library;
  MotionLoader loader(read);
  std::vector<Pose> poses;
  std::vector<int> motion;
  for (std::size_t f = 0; f < files.size(); ++f) {
    try {
      const auto [all, fps] = loader.load(files[f]);
      const std::size_t step = options.every * std::max(1L, std::lround(fps / kUsualFps));
      for (std::size_t i = 0; i < all.size(); i += step) {
        ++library.frames;
        const bool twisted = hands_twisted(all[i]), intersects = !twisted && intersects_itself(all[i]);
        library.twisted += twisted ? 1 : 0;
        library.intersecting += intersects ? 1 : 0;
        if (twisted || intersects) continue;
        poses.push_back(all[i]);
        motion.push_back(static_cast<int>(f));
      }
    } catch (const Error& e) {
      library.skipped.emplace_back(e.what());
    }
  }
  if (!files.empty() && library.skipped.size() == files.size()) {
    throw Error(fmt::format("none of {} motions can be used: {}", files.size(), library.skipped[0]));
  }
  for (const int i : thin_poses(poses, options.min_angle_deg * kDegree)) {
    const Pose& pose = poses[i];
    library.poses.push_back({pose, classify_posture(pose)});
    library.motion.push_back(motion[i]);
  }
  return library;
}

}  // namespace vesalius::synth
