#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "synth/mocap/asf.h"
#include "synth/mocap/motion.h"
#include "synth/mocap/motion_list.h"
#include "synth/pose/pose.h"
#include "synth/text/read_text.h"

namespace vesalius::synth {

/// Reads motions of all formats. A skeleton that several motions share is read once.
class MotionReader {
 public:
  /// Keeps a reference.
  explicit MotionReader(const ReadText& read) : read_(read) {}

  /// Throws Error naming the file, also for an .amc without a skeleton.
  Motion read(const MotionFile& file);

 private:
  const AsfSkeleton& skeleton(const std::string& path);

  const ReadText& read_;
  std::map<std::string, AsfSkeleton> skeletons_;
};

/// Returns n where every nth frame of a recording gives about 30 frames a second; 1 below 45.
std::size_t usual_step(float fps);

/// Returns whether a hand is turned impossibly far. Forearm and wrist together turn a hand by about 90 degrees to
/// either side, but solvers of marker data sometimes lose the hand's turn and give any angle.
bool hands_twisted(const Pose& pose);

}  // namespace vesalius::synth
