#pragma once

#include <Eigen/Geometry>
#include <string>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Where cameras stand and how far people are from them.
struct CameraPlacement {
  float height_min_m = 0.4F;  ///< above the floor
  float height_max_m = 2.2F;
  float pitch_min_deg = -15.F;  ///< downwards; 90 looks straight down
  float pitch_max_deg = 45.F;
  float roll_max_deg = 4.F;     ///< to either side
  float aim_error_deg = 6.F;    ///< standard deviation of the pitch about the one that aims at the first person
  float distance_min_m = 0.6F;  ///< from the camera to the middle of a person
  float distance_max_m = 5.5F;
  float usual_min_m = 1.5F;  ///< most people are within this range
  float usual_max_m = 3.5F;
  float usual_share = 0.6F;
};

/// `room`: on furniture, shelves and tripods; `ceiling`: 2.2 to 3 m up, looking down; `wheelchair`: 0.6 to 1.1 m up,
/// near. Throws UsageError listing the names for another.
CameraPlacement camera_placement(const std::string& mounting);

void visit_options(const std::string& prefix, CameraPlacement& options, OptionVisitor& visitor);

/// Throws UsageError naming an option out of its range, or a smallest value above its largest.
void check(const CameraPlacement& options);

/// How a camera is held.
struct CameraPose {
  float height_m = 1.F;
  float pitch_rad = 0.F;  ///< downwards
  float roll_rad = 0.F;   ///< clockwise as the camera sees it

  /// The camera stands above the world's origin and looks along -z (of the world: y up).
  Eigen::Isometry3f world_from_camera() const;
};

/// Draws a camera that looks about at a point `target_height_m` above the floor, `distance_m` away.
CameraPose sample_camera(const CameraPlacement& options, float target_height_m, float distance_m, Random& random);

/// Draws how far a person is, metres.
float sample_distance(const CameraPlacement& options, Random& random);

}  // namespace vesalius::synth
