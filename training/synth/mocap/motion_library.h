#pragma once

#include <span>
#include <string>
#include <vector>

#include "synth/mocap/motion_list.h"
#include "synth/pose/movement.h"
#include "synth/pose/pose_sampler.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

struct PoseLibraryOptions {
  int every = 2;              ///< takes every nth frame after reduction to about 30 frames a second
  float min_angle_deg = 5.F;  ///< smallest angle by which a pose differs in some joint from every other
};

void visit_options(const std::string& prefix, PoseLibraryOptions& options, OptionVisitor& visitor);

/// Poses of recorded motions that differ from each other.
struct PoseLibrary {
  std::vector<SampledPose> poses;
  std::vector<std::string> skipped;  ///< one line for each file that could not be used, with the reason
};

/// Loads a library of poses. Motions of 45 and more frames a second are reduced to about 30 by taking every nth frame,
/// beginning with the first (CMU and HDM05 recorded 120, so every 4th). Impossible poses are left out: those in which
/// the body intersects itself (with `touch_m` as in intersects_itself()) or a marker's error has turned a hand back to
/// front. The others are thinned (section 4.1.2). A file that cannot be used is skipped and named in `skipped`. Throws
/// Error if all files are skipped, and UsageError for options out of range.
PoseLibrary load_pose_library(std::span<const MotionFile> files, const ReadText& read,
                              const PoseLibraryOptions& options = {}, float touch_m = kTouch_m);

/// What people do in clips, taken from recorded motions at about 30 frames a second. Recordings without any of it, such
/// as jumps, and those with a marker's error are in none of the lists.
struct MovementLibrary {
  std::vector<Gait> gaits;          ///< walks
  std::vector<Movement> stays;      ///< what somebody does standing at one place
  std::vector<Movement> lie_downs;  ///< from standing to lying on the floor

  bool empty() const { return gaits.empty() && stays.empty() && lie_downs.empty(); }
};

/// Loads a library of movements. Files that cannot be used are skipped.
MovementLibrary load_movements(std::span<const MotionFile> files, const ReadText& read);

}  // namespace vesalius::synth
