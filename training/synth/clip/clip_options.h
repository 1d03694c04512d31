#pragma once

#include <string>

#include "vesalius/base/options.h"

namespace vesalius::synth {

inline constexpr int kMostClipCameras = 8;

/// What people and camera do in clips. Single frames do not depend on it.
struct ClipOptions {
  float walking_share = 0.75F;  ///< share of people who walk about; the others stay where they are
  float pause_share = 0.35F;    ///< share of ways that end with a stay
  float leaving_share = 0.1F;   ///< share of ways that lead out of the picture
  float crossing_share = 0.9F;  ///< share of clips with walking people and others in which they pass before each other
  float falling_share = 0.F;    ///< share of people who stand, fall and remain lying, whatever else they would do
  float rising_share = 0.F;     ///< share of those who fall or lie down who get up again
  float seating_share = 0.F;    ///< share of people on seats who sit down or get up in the clip
  float moving_share = 0.5F;    ///< share of clips whose camera moves
  float speed_max_m_s = 0.3F;   ///< greatest speed of the camera
  float turn_max_deg_s = 20.F;  ///< fastest turn of the camera
  int cameras = 1;              ///< that see the same people; several of them stand
  int seen_from = 0;            ///< the one of them whose pictures are made
  float apart_deg = 90.F;       ///< angle about the middle of the scene from each camera to the next
};

void visit_options(const std::string& prefix, ClipOptions& options, OptionVisitor& visitor);

}  // namespace vesalius::synth
