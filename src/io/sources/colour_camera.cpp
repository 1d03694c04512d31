#include "io/sources/colour_camera.h"

#include <algorithm>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using Eigen::Isometry3d;

/// Returns how depth's points come to the camera of colour, as far as it is said. Of one transform without names the
/// usual way is that from depth to colour: librealsense, Kinects and Orbbec give that, and stereo calibrations that
/// from the first camera to the second.
std::optional<Isometry3d> colour_from_depth(const CameraFacts& facts, bool first_is_colour, bool by_columns) {
  using enum CameraRole;
  std::optional<Isometry3d> of_depth, of_colour, alone;
  for (const RigidFact& fact : facts.transforms) {
    Isometry3d transform = fact.transform;
    if (by_columns && fact.in_one_list) transform.linear().transposeInPlace();
    if (fact.from == depth && fact.to == colour) return transform;
    if (fact.from == colour && fact.to == depth) return transform.inverse();
    std::optional<Isometry3d>& place = fact.to == depth ? of_depth : fact.to == colour ? of_colour : alone;
    if (!place) place = transform;
  }
  if (of_depth && of_colour) return *of_colour * of_depth->inverse();
  if (alone) return first_is_colour ? alone->inverse() : *alone;
  return of_depth ? of_depth : of_colour;
}

/// Returns the camera of facts for pictures of a size; nothing where they are of other pictures.
std::optional<LensCamera> camera_for(CameraFacts facts, int width, int height) {
  facts.others.clear();
  std::vector<std::string> ignored;
  try {
    const Camera pinhole = resolve_camera(facts, width, height, false, facts.origin, ignored);
    LensCamera all{pinhole, {}};
    if (facts.distorted) all.lens = facts.distorted->lens;
    if (facts.distorted && facts.distorted->camera.width == width) all.camera = facts.distorted->camera;
    return all;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<ColourCamera> find_colour_camera(const CameraFacts& facts, const Camera& depth, int width, int height,
                                               std::string& missing) {
  if (const auto& k4a = facts.k4a; k4a && k4a_depth_calibration(*k4a, depth.width, depth.height)) {
    const auto colour = k4a_colour_calibration(*k4a, width, height);
    if (colour) return ColourCamera{calibrated(*colour, false).lens, k4a->colour->sensor_from_depth};
  }
  const bool same_size = width == depth.width && height == depth.height;
  // Depth on the grid of colour, whose calibration is that of both.
  const bool of_colour =
      facts.role == CameraRole::colour || (facts.calibrated_width == width && facts.calibrated_height == height);
  if (of_colour && facts.role != CameraRole::depth) {
    if (same_size || width * depth.height != height * depth.width) return std::nullopt;
    const double by = double(depth.width) / width;
    ColourCamera colour{{scaled(depth, by, width, height), {}}};
    if (facts.distorted) colour.lens = {scaled(facts.distorted->camera, by, width, height), facts.distorted->lens};
    return colour;
  }
  const auto is_other = [&](const CameraFacts& other) {
    return other.role == CameraRole::colour || (facts.role == CameraRole::first && other.role == CameraRole::second) ||
           (facts.role == CameraRole::second && other.role == CameraRole::first);
  };
  bool known = false;
  std::optional<LensCamera> lens;
  for (const CameraFacts& other : facts.others) {
    if (!is_other(other)) continue;
    known = true;
    if (lens = camera_for(other, width, height); lens) break;
  }
  const bool by_columns = facts.from_librealsense ||
                          std::ranges::any_of(facts.others, [](const CameraFacts& f) { return f.from_librealsense; });
  const auto transform = colour_from_depth(facts, facts.role == CameraRole::second, by_columns);
  if (lens && transform) return ColourCamera{*lens, *transform};
  if (lens || known || transform) {
    missing = !known  ? "no calibration of colour's camera"
              : !lens ? "the calibration of colour is of other pictures"
                      : "rotation and translation between the cameras are not beside the pictures";
  }
  return std::nullopt;
}

}  // namespace vesalius
