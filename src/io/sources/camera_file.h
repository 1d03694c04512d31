#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/k4a_messages.h"
#include "io/sources/rigid_facts.h"
#include "vesalius/camera.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// The known facts about a camera. Anything that a file leaves out is empty.
struct CameraFacts {
  std::optional<float> fx, fy, cx, cy;  ///< pixels
  std::optional<int> width, height;     ///< size of the pictures that fx ... cy are for
  std::optional<float> depth_scale;     ///< stored units per metre
  DepthBits depth_bits = DepthBits::plain;
  std::optional<double> rate_hz;  ///< frames a second
  std::string sensor;             ///< e.g. "Kinect v1"; empty = not named
  /// The camera behind its lens, where that distorts: what pictures are turned from. Those that they are turned into
  /// have fx ... cy. Its size is 0 where none is given.
  std::optional<LensCamera> distorted;
  std::string odd_lens;  ///< model of a distortion that is not known and stays; empty = none
  std::string origin;    ///< the file, for messages
  std::string lacks;     ///< of a file without focal length: what was looked for there and what it has instead
  std::vector<CameraFacts> others;                  ///< further cameras, for pictures of their sizes
  std::optional<K4aCalibration> k4a;                ///< of which fx ... cy follow for pictures of each size
  int calibrated_width = 0, calibrated_height = 0;  ///< size of the pictures that it was for, where it was scaled
  CameraRole role = CameraRole::unsaid;
  bool from_librealsense = false;     ///< by its names of facts
  std::vector<RigidFact> transforms;  ///< between cameras

  bool has_focal() const { return fx.has_value() || k4a.has_value(); }
  /// Fills in from `other` what is missing here.
  void fill_from(const CameraFacts& other);
};

/// Reads what tells of a camera, by the names that tools give: meta.json, camera_info of ROS 1 and 2 as saved or
/// printed, OpenCV's FileStorage, librealsense, Open3D, ORB-SLAM, Kalibr, an Azure Kinect's calibration.json, Orbbec's,
/// a matrix of 3x3 or 4x4 numbers, "fx fy cx cy"; JSON, YAML, TOML, INI or plain text. meta.json adds units ("mm", "cm"
/// or "m"; words after it are ignored), depth_scale (stored units per metre, or metres or millimetres a unit where it
/// is 1 or less), rate_hz (frames a second) and sensor. Everything may be missing. Of several cameras the one named
/// depth comes first. If the lens is distorted, fx ... cy are those of the rectified pictures (projection matrix),
/// where there are any. Throws Error naming `name`, the key and what was expected.
CameraFacts parse_camera(std::string_view text, const std::string& name);

/// Returns the text of a meta.json that `parse_camera` reads back exactly. `depth_scale` is in stored units per metre,
/// `rate_hz` in frames a second.
std::string serialise_meta(const Camera& camera, float depth_scale = 1000.F, std::optional<float> rate_hz = {});

/// Returns the facts that `options` state. Missing ones come from the camera file that `options` name; without such a
/// file they come from meta.json, camera_info.yaml, intrinsics.txt and the like in the first of `folders` that has one.
/// Throws Error for an unusable file or value.
CameraFacts find_camera_facts(const SourceOptions& options, const std::vector<std::string>& folders);

/// Returns the camera of pictures of `width` x `height` pixels. fy defaults to fx and the principal point to the
/// centre. If fx is missing, the usual focal length of the named sensor is taken (`registered`: depth was warped onto
/// the colour camera's grid). Facts for pictures of another size become those of this one where the file has such a
/// camera or the sizes have a whole ratio. Guesses and assumptions are added to `notes`. Throws Error naming `place` if
/// no focal length is known, or both sizes.
Camera resolve_camera(CameraFacts& facts, int width, int height, bool registered, const std::string& place,
                      std::vector<std::string>& notes);

/// Returns the camera of pictures whose pixels are `by` times as large; centres of pixels are at whole numbers.
Camera scaled(const Camera& camera, double by, int width, int height);

/// A calibration as cameras are made of it.
struct CalibratedCamera {
  Camera pinhole;  ///< that the pictures are of once nothing distorts them
  LensCamera lens;
  std::string odd_model;  ///< model of distortion, where that is not known
};

/// Returns the camera of a calibration. `is_rectified` says that its pictures are those that the calibration turns
/// others into. Numbers are as calibrated: `check` says whether they are those of a camera.
CalibratedCamera calibrated(const Calibration& calibration, bool is_rectified);

}  // namespace vesalius
