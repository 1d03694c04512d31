#include "synth/mocap/pose_library.h"

#include <fmt/format.h>

#include "synth/mocap/motion_reader.h"
#include "synth/mocap/retarget.h"
#include "synth/mocap/thin_poses.h"
#include "synth/pose/posture.h"
#include "synth/pose/self_contact.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kDegree = 3.14159265F / 180.F;

}  // namespace

void visit_options(const std::string& prefix, PoseLibraryOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "every", options.every, {"", 1, 1000, "Takes every so many frames of a recorded motion."});
  visitor.option(prefix + "min-angle", options.min_angle_deg,
                 {"deg", 0.0, 180.0, "Angle by which a pose must differ in some joint from every other one kept."});
}

PoseLibrary load_pose_library(std::span<const MotionFile> files, const ReadText& read,
                              const PoseLibraryOptions& options) {
  PoseLibraryOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);

  PoseLibrary library;
  MotionReader reader(read);
  std::vector<Pose> poses;
  std::vector<int> motion;
  for (std::size_t f = 0; f < files.size(); ++f) {
    try {
      const Motion recorded = reader.read(files[f]);
      const std::vector<Pose> all = retarget(recorded, find_convention(recorded, builtin_conventions()));
      const auto step = static_cast<std::size_t>(options.every) * usual_step(recorded.fps);
      for (std::size_t i = 0; i < all.size(); i += step) {
        ++library.frames;
        const bool twisted = hands_twisted(all[i]), intersects = !twisted && intersects_itself(all[i]);
        library.twisted += twisted ? 1 : 0;
        library.intersecting += intersects ? 1 : 0;
        if (twisted || intersects) continue;
        poses.push_back(all[i]);
        motion.push_back(int(f));
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
