#pragma once

#include <k4a/k4atypes.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "io/lens/colour_registration.h"
#include "io/lens/lens.h"
#include "k4abt/k4a_library.h"
#include "vesalius/frame.h"

namespace vesalius::k4abt {

/// Makes frames of the captures of one camera: lens undone, colour on the grid of depth. What is found in them goes
/// back into the pictures that the camera took.
class CaptureReader {
 public:
  /// `quarter_turns` is Frame::quarter_turns. Throws UsageError for a calibration without depth, or of another kind of
  /// lens than Brown and Conrady's.
  CaptureReader(const k4a_calibration_t& calibration, std::optional<int> quarter_turns);

  /// Returns the camera of the frames.
  const Camera& camera() const { return camera_.camera; }

  /// Returns the capture's picture of depth. Throws UsageError if it has none, or one of another format or size.
  ImageReference depth_of(k4a_capture_t capture) const;

  /// Returns the capture as a frame; its time is the device's, else the host's, and none where both are 0. Colour that
  /// cannot be read is left out, and one line says so. Throws as depth_of.
  Frame read(k4a_capture_t capture) const;

  /// Returns a picture of the frame as one of the camera: each pixel has the value of that which shows the same, and
  /// `outside` where the frame does not show it.
  Image<std::uint8_t> to_camera(const Image<std::uint8_t>& picture, std::uint8_t outside) const;

 private:
  ColourImage colour_of(k4a_capture_t capture, const DepthImage& depth) const;
  void find_sources();

  LensCamera camera_;
  std::optional<int> quarter_turns_;
  std::optional<Rectification> rectification_;  ///< none where the lens does nothing
  std::optional<ColourRegistration> registration_;
  std::vector<std::int32_t> sources_;  ///< pixel of the frame for each of the camera; -1 = none; empty = the same
};

}  // namespace vesalius::k4abt
