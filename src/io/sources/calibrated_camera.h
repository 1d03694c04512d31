#pragma once

#include <string>

#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"

namespace vesalius {

/// A calibration as cameras are made of it.
struct CalibratedCamera {
  Camera pinhole;  ///< that the pictures are of once nothing distorts them
  LensCamera lens;
  std::string odd_model;  ///< of distortion, where that is not known
};

/// Returns the camera of a calibration. `is_rectified` says that its pictures are those that the calibration turns
/// others into. Numbers are as calibrated: `check` says whether they are those of a camera.
CalibratedCamera calibrated(const Calibration& calibration, bool is_rectified);

}  // namespace vesalius
