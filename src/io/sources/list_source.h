#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/lens/rectification.h"
#include "io/sources/camera_file.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// The files of one frame.
struct FrameFiles {
  std::string name;
  std::optional<double> time_s;  ///< seconds, as in Frame
  std::string depth;             ///< path of a 16-bit PNG
  std::string colour;            ///< path of a PNG or JPEG of the same size; empty = none
};

/// Frames whose depth and colour pictures are files of their own, in order. Either all have times, and they rise, or
/// none.
struct FrameList {
  std::string place;  ///< for messages
  std::vector<FrameFiles> frames;
  CameraFacts facts;
  CameraFacts fallback;          ///< camera where `facts` has none and the size fits; fx empty = none
  float default_scale = 1000.F;  ///< stored units per metre where `facts` has none
  std::vector<std::string> notes;
};

/// Reads the frames of a list in any order. It may be used from several threads.
class FrameListReader {
 public:
  /// Throws Error if the first picture is unusable or the camera is unknown.
  explicit FrameListReader(FrameList list);

  std::size_t size() const { return list_.frames.size(); }
  const FrameList& list() const { return list_; }
  const Camera& camera() const { return camera_; }
  /// Returns whether frames differ from the pictures in the files, since the lens distorts those.
  bool is_rectified() const { return rectification_.has_value(); }

  /// Returns frame `index`, which must be below size(). Throws Error naming a picture that cannot be read or differs in
  /// size from the first.
  Frame read(std::size_t index, bool with_colour = true) const;

 private:
  FrameList list_;
  Camera camera_;
  std::optional<Rectification> rectification_;
  float units_per_m_ = 1000.F;
};

/// Returns a source that reads the pictures one by one. Throws Error as FrameListReader does.
std::unique_ptr<FrameSource> open_list(FrameList list);

/// Converts stored depth to millimetres. A result over 65535 mm does not fit and becomes 0, no reading.
DepthImage to_millimetres(const Image<std::uint16_t>& stored, float units_per_m);

}  // namespace vesalius
