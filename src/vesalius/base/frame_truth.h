#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"

namespace vesalius {

/// Whether the camera stood still when it took a frame.
enum class CameraMotion { unknown, still, moving };

/// What is known about a frame; what is not known is empty.
struct FrameTruth {
  int people = -1;             ///< exact number in view; -1: at least one
  std::string posture;         ///< a word for what they do
  Mask mask;                   ///< non-zero on the pixels of all people
  Image<std::uint8_t> person;  ///< index of each pixel's person, kBackground elsewhere
  LabelImage labels;           ///< part of each pixel, kBackground elsewhere
  std::string joint_set;       ///< of the body, to compare joints with; empty: the first one that has all of them
  std::vector<std::string> joint_names;
  std::vector<std::vector<Eigen::Vector3f>> joints;  ///< [person][joint]: metres, optical frame; NaN = not known
  CameraMotion camera_motion = CameraMotion::unknown;
};

/// A frame with whatever is known about it.
struct TrueFrame {
  Frame frame;
  FrameTruth truth;
};

}  // namespace vesalius
