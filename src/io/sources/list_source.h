#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "io/sources/camera_file.h"
#include "io/sources/open_source.h"

namespace vesalius {

/// Where one frame lies.
struct FrameFiles {
  std::string name;
  double time_s = 0.0;
  std::string depth;   ///< path of a 16-bit PNG
  std::string colour;  ///< path of a PNG or JPEG of the same size; empty = none
};

/// Depth and colour pictures in files of their own, in the order of the frames.
struct FrameList {
  std::string place;  ///< for messages
  std::vector<FrameFiles> frames;
  CameraFacts facts;
  CameraFacts fallback;          ///< camera where `facts` has none and the size fits; fx empty = none
  float default_scale = 1000.F;  ///< stored units per metre where `facts` has none
  std::vector<std::string> notes;
};

/// A source that reads the pictures one by one. A frame that cannot be read is passed over by the next call. Throws
/// Error when the first picture is unusable, the camera unknown, or a picture differs from the first in size.
std::unique_ptr<FrameSource> open_list(FrameList list);

/// Stored depth to millimetres. What rounds to more than 65535 mm cannot be held and becomes 0, no reading.
DepthImage to_millimetres(const Image<std::uint16_t>& stored, float units_per_m);

}  // namespace vesalius
