#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "io/lens/lens.h"
#include "io/recordings/recording.h"
#include "io/sources/camera_file.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// The topics that frames are made of, and the cameras that recorded them.
struct RecordedCameras {
  struct Depth {
    std::string topic;
    int width = 0, height = 0;
    double time_s = 0.0;      ///< time of the first picture
    double recorded_s = 0.0;  ///< when that was recorded
    int left_out = 0;         ///< messages before it that are no whole pictures
    CameraFacts facts;        ///< as recorded
  };
  struct Colour {
    std::string topic;
    double time_s = 0.0, recorded_s = 0.0;  ///< of the first picture, as of depth
    /// The camera; none where the pictures are pixel by pixel those of the depth camera.
    std::optional<LensCamera> camera;
    Eigen::Isometry3d colour_from_depth = Eigen::Isometry3d::Identity();  ///< transform to `camera` from depth, metres
    /// The lens of pictures on the grid of depth, where it distorts.
    std::optional<LensCamera> distorted;
  };
  struct Acceleration {
    std::string topic;
    Eigen::Matrix3d optical_from_sensor = Eigen::Matrix3d::Identity();
  };
  Depth depth;
  std::optional<Colour> colour;
  std::optional<Acceleration> acceleration;
  std::vector<SourceItem> items;  ///< all topics, taken or not
};

/// Looks at the first messages of a recording, which it rewinds, and chooses. Depth is what names call so, rather than
/// what has its encoding: infrared has it too. Colour is taken where it lies on the grid of depth; else where
/// calibrations and transforms connect the two cameras. Accelerations are taken where they are
/// measured in the frame of depth, or transforms connect that. `notes` receives what else there is. Throws Error naming
/// `place` and all topics if there is no depth, UsageError if `options` name topics that are not there.
RecordedCameras choose_cameras(Recording& recording, const SourceOptions& options, const std::string& place,
                               std::vector<std::string>& notes);

}  // namespace vesalius
