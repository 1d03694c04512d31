#pragma once

#include <Eigen/Geometry>
#include <string>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// The placement of cameras and their distance from people.
struct CameraPlacement {
  float height_min_m = 0.4F;  ///< above the floor
  float height_max_m = 2.2F;
  float pitch_min_deg = -15.F;  ///< downwards; a camera at 90 looks straight down
  float pitch_max_deg = 45.F;
  float roll_max_deg = 4.F;     ///< to either side
  float rolled_share = 0.F;     ///< share of cameras that are rolled up to `rolled_max_deg` instead
  float rolled_max_deg = 90.F;  ///< to either side; 90 stands on its side
  float aim_error_deg = 6.F;    ///< standard deviation of the pitch about the one that aims at the first person
  float distance_min_m = 0.6F;  ///< distance from the camera to the middle of a person
  float distance_max_m = 5.5F;
  float usual_min_m = 1.5F;  ///< most people are within this range of distances
  float usual_max_m = 3.5F;
  float usual_share = 0.6F;
};

/// Returns the placement for a mounting. `room` is on furniture, shelves and tripods; `ceiling` is 2.2 to 3 m up and
/// looks down; `wheelchair` is 0.6 to 1.1 m up and near. Throws UsageError listing the names for any other word.
CameraPlacement camera_placement(const std::string& mounting);

void visit_options(const std::string& prefix, CameraPlacement& options, OptionVisitor& visitor);

/// Throws UsageError naming an option that is out of its range, or a minimum above its maximum.
void check(const CameraPlacement& options);

/// The height and orientation of a camera.
struct CameraPose {
  float height_m = 1.F;
  float pitch_rad = 0.F;  ///< downwards
  float roll_rad = 0.F;   ///< clockwise as seen from the camera

  /// Returns the transformation from camera to world. The camera is above the world's origin and looks along the
  /// world's -z; y points up.
  Eigen::Isometry3f world_from_camera() const;
};

/// Draws a camera that looks approximately at a point `target_height_m` above the floor and `distance_m` away.
CameraPose sample_camera(const CameraPlacement& options, float target_height_m, float distance_m, Random& random);

/// Draws the distance of a person in metres.
float sample_distance(const CameraPlacement& options, Random& random);

}  // namespace vesalius::synth
