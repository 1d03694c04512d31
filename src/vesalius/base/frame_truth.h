#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"

namespace vesalius {

/// Tells whether the camera moved when it took a frame.
enum class CameraMotion { unknown, still, moving };

/// The known facts about a frame. Unknown ones are empty.
struct FrameTruth {
  int people = -1;             ///< exact number in view, or -1 for at least one
  std::string posture;         ///< one word for their posture
  Mask mask;                   ///< non-zero on the pixels of all people
  Image<std::uint8_t> person;  ///< index of each pixel's person, kBackground elsewhere
  LabelImage labels;           ///< part of each pixel, kBackground elsewhere
  std::string joint_set;       ///< joint set of the body to compare with; if empty, the first that has all joints
  std::vector<std::string> joint_names;
  std::vector<std::vector<Eigen::Vector3f>> joints;  ///< [person][joint]: metres, optical frame; NaN = not known
  CameraMotion camera_motion = CameraMotion::unknown;
};

/// A frame with its truth.
struct TrueFrame {
  Frame frame;
  FrameTruth truth;
};

}  // namespace vesalius
