#include "synth/mocap/motion_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "synth/mocap/motion.h"
#include "synth/mocap/retarget.h"
#include "synth/mocap/thin_poses.h"
#include "synth/pose/joint_angles.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kDegree = 3.14159265F / 180.F;

/// Reads motions of all formats. A skeleton that several motions share is read once.
class MotionReader {
 public:
  /// Keeps a reference.
  explicit MotionReader(const ReadText& read) : read_(read) {}

  /// Throws Error naming the file, also for an .amc without a skeleton.
  Motion read(const MotionFile& file) {
    if (!file.path.ends_with(".amc") && !file.path.ends_with(".AMC")) return parse_bvh(read_(file.path), file.path);
    if (file.skeleton.empty()) {
      throw Error(fmt::format("{}: no skeleton: expected an .asf beside it with the beginning of its name", file.path));
    }
    return parse_amc(read_(file.path), file.path, skeleton(file.skeleton), file.fps);
  }

 private:
  const AsfSkeleton& skeleton(const std::string& path) {
    const auto found = skeletons_.find(path);
    if (found != skeletons_.end()) return found->second;
    return skeletons_.emplace(path, parse_asf(read_(path), path)).first->second;
  }

  const ReadText& read_;
  std::map<std::string, AsfSkeleton> skeletons_;
};

/// Returns n where every nth frame of a recording gives about 30 frames a second; 1 below 45.
std::size_t usual_step(float fps) {
  constexpr float kUsualFps = 30.F;
  return static_cast<std::size_t>(std::max(1L, std::lround(fps / kUsualFps)));
}

/// Returns whether a hand is turned impossibly far. Forearm and wrist together turn a hand by about 90 degrees to
/// either side, but solvers of marker data sometimes lose the hand's turn and give any angle.
bool hands_twisted(const Pose& pose) {
  constexpr float kMost = 110.F;
  const auto twisted = [&](bool left) { return std::abs(arm_angles(pose, left).pronation) > kMost; };
  return twisted(true) || twisted(false);
}

/// Returns every nth state, so that about 30 a second are left.
Movement thinned(Movement movement) {
  const std::size_t step = usual_step(movement.fps);
  if (step == 1) return movement;
  std::vector<BodyState> kept;
  for (std::size_t i = 0; i < movement.states.size(); i += step) kept.push_back(movement.states[i]);
  movement.states = std::move(kept);
  movement.fps /= float(step);
  return movement;
}

/// Returns whether no joint turns faster than people can and no hand is back to front: marker data has such errors.
bool is_sound(const Movement& movement) {
  constexpr float kFastest = 1300.F * kDegree, kFastestTurn = 500.F * kDegree, kFastestRoot = 6.F;
  const auto& states = movement.states;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (hands_twisted(states[i].pose)) return false;
    if (i == 0) continue;
    if (largest_angle(states[i - 1].pose, states[i].pose) * movement.fps > kFastest) return false;
    if (std::abs(states[i].heading_rad - states[i - 1].heading_rad) * movement.fps > kFastestTurn) return false;
    if ((states[i].root - states[i - 1].root).norm() * movement.fps > kFastestRoot) return false;
  }
  return true;
}

/// Returns whether both feet leave the floor, as in runs and jumps. Bodies are put on the floor in every frame, which
/// would look wrong there.
bool leaves_floor(const Movement& movement) {
  constexpr float kHighest_m = 0.15F;
  const float leg_m = bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin);
  float lowest = std::numeric_limits<float>::max(), highest = -lowest;
  for (const BodyState& state : movement.states) {
    const StickFigure figure = stick_figure(state.pose);
    float foot_m = std::numeric_limits<float>::max();
    for (std::size_t b = 0; b < kBoneCount; ++b) foot_m = std::min({foot_m, figure.head[b].y(), figure.tail[b].y()});
    const float clear_m = state.height * leg_m + foot_m;
    lowest = std::min(lowest, clear_m);
    highest = std::max(highest, clear_m);
  }
  return highest > lowest + kHighest_m;
}

/// Returns the share of states, of every few, in which the body intersects itself.
float intersecting_share(const Movement& movement) {
  constexpr std::size_t kEvery = 6;
  int looked = 0, intersecting = 0;
  for (std::size_t i = 0; i < movement.states.size(); i += kEvery) {
    ++looked;
    intersecting += intersects_itself(movement.states[i].pose) ? 1 : 0;
  }
  return float(intersecting) / float(looked);
}

bool stands_throughout(const Movement& movement) {
  return std::ranges::all_of(movement.states,
                             [](const BodyState& s) { return classify_posture(s.pose) == Posture::standing; });
}

bool stays_at_one_place(const Movement& movement) {
  constexpr float kFarthest = 0.45F, kMostTurn = 60.F * kDegree;
  const BodyState& first = movement.states.front();
  return std::ranges::all_of(movement.states, [&](const BodyState& s) {
    return (s.root - first.root).norm() < kFarthest && std::abs(s.heading_rad - first.heading_rad) < kMostTurn;
  });
}

/// Puts a movement into the list to which it belongs, if there is one.
void sort_in(Movement movement, MovementLibrary& library) {
  constexpr float kShortest_s = 0.8F, kMostIntersecting = 0.2F;
  if (movement.states.size() < 2 || movement.seconds() < kShortest_s || !is_sound(movement)) return;
  if (intersecting_share(movement) > kMostIntersecting) return;
  const Posture begins = classify_posture(movement.states.front().pose);
  const Posture ends = classify_posture(movement.states.back().pose);
  if (begins == Posture::standing && ends == Posture::lying) return library.lie_downs.push_back(std::move(movement));
  if (!stands_throughout(movement) || leaves_floor(movement)) return;
  if (std::optional<Gait> gait = find_gait(movement)) return library.gaits.push_back(std::move(*gait));
  if (stays_at_one_place(movement)) library.stays.push_back(std::move(movement));
}

}  // namespace

void visit_options(const std::string& prefix, PoseLibraryOptions& options, OptionVisitor& visitor) {
  visitor.option(prefix + "every", options.every, {"", 1, 1000, "Takes every so many frames of a recorded motion."});
  visitor.option(prefix + "min-angle", options.min_angle_deg,
                 {"deg", 0.0, 180.0, "Angle by which a pose must differ in some joint from every other one kept."});
}

PoseLibrary load_pose_library(std::span<const MotionFile> files, const ReadText& read,
                              const PoseLibraryOptions& options, float touch_m) {
  PoseLibraryOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);

  PoseLibrary library;
  MotionReader reader(read);
  std::vector<Pose> poses;
  for (const MotionFile& file : files) {
    try {
      const Motion recorded = reader.read(file);
      const std::vector<Pose> all = retarget(recorded, find_convention(recorded, builtin_conventions()));
      const auto step = static_cast<std::size_t>(options.every) * usual_step(recorded.fps);
      for (std::size_t i = 0; i < all.size(); i += step) {
        if (!hands_twisted(all[i]) && !intersects_itself(all[i], touch_m)) poses.push_back(all[i]);
      }
    } catch (const Error& e) {
      library.skipped.emplace_back(e.what());
    }
  }
  if (!files.empty() && library.skipped.size() == files.size()) {
    throw Error(fmt::format("none of {} motions can be used: {}", files.size(), library.skipped[0]));
  }
  for (const int i : thin_poses(poses, options.min_angle_deg * kDegree)) {
    library.poses.push_back({poses[i], classify_posture(poses[i])});
  }
  return library;
}

MovementLibrary load_movements(std::span<const MotionFile> files, const ReadText& read) {
  MovementLibrary library;
  MotionReader reader(read);
  for (const MotionFile& file : files) {
    try {
      const Motion motion = reader.read(file);
      sort_in(thinned(retarget_movement(motion, find_convention(motion, builtin_conventions()))), library);
    } catch (const Error&) {
      continue;  // a file that cannot be read is named by load_pose_library()
    }
  }
  return library;
}

}  // namespace vesalius::synth
