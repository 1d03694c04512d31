#pragma once

#include <span>
#include <string>
#include <vector>

#include "synth/mocap/motion_list.h"
#include "synth/pose/pose_sampler.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

struct PoseLibraryOptions {
  int every = 2;              ///< takes every so many frames of a motion brought down to about 30 frames a second
  float min_angle_deg = 5.F;  ///< by which a pose must differ in some joint from every other
};

void visit_options(const std::string& prefix, PoseLibraryOptions& options, OptionVisitor& visitor);

/// Poses of recorded motions, thinned.
struct PoseLibrary {
  std::vector<SampledPose> poses;
  std::vector<int> motion;           ///< per pose: index in the files it was loaded from
  std::vector<std::string> skipped;  ///< one line for each file that could not be used: what was wrong with it
  int frames = 0;                    ///< taken from the motions, before any was left out
  int intersecting = 0;              ///< of these: left out since the body ran through itself
  int twisted = 0;                   ///< of these: left out since a hand was turned further than any can be
};

/// Reads one motion by its extension. Throws Error naming the file: also an .amc without a skeleton.
std::vector<Pose> load_motion(const MotionFile& file, const ReadText& read);

/// Loads motions, brings those of 45 and more frames a second down to about 30 by taking every nth frame, the first one
/// included (CMU and HDM05 recorded 120: every 4th), leaves out poses that cannot be (the body runs through itself, a
/// marker's error has turned a hand back to front), thins the rest (section 4.1.2). A file that cannot be used is
/// skipped and named in `skipped`. Throws Error where all had to be, UsageError for options out of range.
PoseLibrary load_pose_library(std::span<const MotionFile> files, const ReadText& read,
                              const PoseLibraryOptions& options = {});

}  // namespace vesalius::synth
