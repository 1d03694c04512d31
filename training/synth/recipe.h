#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "synth/body/makehuman.h"
#include "synth/clip/clip_options.h"
#include "synth/dress/outfit.h"
#include "synth/mocap/motion_library.h"
#include "synth/scene/build_scene.h"
#include "synth/sensor/colour_camera.h"
#include "synth/sensor/depth_filter.h"
#include "synth/sensor/sensor.h"
#include "synth/sensor/sensor_variety.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// How many people are in a picture. The numbers are weights; their sum must be above 0.
struct PeopleOptions {
  float none = 0.08F, one = 0.57F, two = 0.23F, three = 0.08F, four = 0.04F;
  float cut_out = 0.F;  ///< share of pictures with people in which everything else is removed
};

struct BodyOptions {
  std::string kind = "auto";  ///< makehuman, builtin, or auto: makehuman if its files are there
  int count = 300;            ///< number of different bodies; each is dressed once
  Population people;          ///< whose bodies they are
};

struct PoseOptions {
  float captured = 0.6F;  ///< share of poses from motion capture; see asks_for_motions()
  float mixed = 0.25F;    ///< share of captured poses with limbs of another pose
  float mirrored = 0.5F;  ///< share of mirrored poses
  std::string include;    ///< words separated by commas; a motion's description must have one; empty takes all
  std::string exclude = default_exclusions();  ///< words that a description must not have
  float touch_mm = 30.F;  ///< how deep limbs may overlap where people press them together; see intersects_itself()
  PoseLibraryOptions library;
  PoseSamplerOptions sampler;

  static std::string default_exclusions();
};

struct SensorOptions {
  std::string preset = "kinect-v1";
  int width = 0, height = 0;                       ///< pixels; 0 takes the preset's
  float fx = 0.F, fy = 0.F, cx = -1.F, cy = -1.F;  ///< pixels at that size; fx 0 and cx, cy < 0 take the preset's
  bool noise = true;
  bool colour = true;
  ColourCameraOptions colour_camera;  ///< applied with noise alone
  SensorVariety variety;              ///< its options have no prefix of their own
  DepthFilterOptions filter;          ///< applied with and without noise
  friend bool operator==(const SensorOptions&, const SensorOptions&) = default;
};

/// Data from files. All of it is optional.
struct BodiesAndMotions {
  std::shared_ptr<const MakeHumanModel> makehuman;
  std::vector<SampledPose> captured;  ///< poses from motion capture
  MovementLibrary movements;          ///< movements from motion capture, which only clips use
};

/// Everything that decides how synthetic frames look (section 4.1). Together with a seed and the files of
/// `BodiesAndMotions` it determines every byte of every frame.
struct Recipe {
  std::string mounting = "room";  ///< sets the camera's options: room, ceiling or wheelchair
  SensorOptions sensor;
  PeopleOptions people;
  BodyOptions body;
  OutfitOptions outfit;
  PoseOptions pose;
  CameraPlacement camera;
  SceneOptions scene;
  ClipOptions clip;
};

void visit_options(const std::string& prefix, Recipe& recipe, OptionVisitor& visitor);

/// Throws UsageError naming the first option that is out of range or has an unknown word.
void check(const Recipe& recipe);
/// Returns the recipe after that check.
Recipe checked(const Recipe& recipe);

/// Returns whether a recipe requires captured poses. It does if it states a share of them other than the default or
/// chooses motions; its frames cannot be made without motions. The default recipe uses captured poses if there are any.
bool asks_for_motions(const PoseOptions& options);

/// Returns how deep pressed limbs may overlap, in metres.
float touch_m(const PoseOptions& options);

/// Returns the choice of motions for a recipe's captured poses.
MotionChoice motion_choice(const PoseOptions& options);

/// Returns the sensor of a recipe: its preset at the requested size and with the requested intrinsics.
Sensor sensor_of(const SensorOptions& options);

/// The purpose of a stream of random numbers. Each purpose has a stream of its own, so that a change of one leaves the
/// others unchanged.
enum class Purpose : std::uint64_t { body, plan, scene, noise, colour_noise, cut_out, filter, camera };
inline constexpr std::uint64_t kPurposes = 8;

inline Random random_for(std::uint64_t seed, Purpose purpose, std::uint64_t index) {
  return Random(seed * kPurposes + static_cast<std::uint64_t>(purpose), index);
}

/// Returns the index of the streams of frame k of a clip, which no single frame has.
inline std::uint64_t clip_stream(std::uint64_t clip, std::uint32_t k) { return ((clip + 1) << 32U) | k; }

/// The place of k for what is the same in a whole clip; the numbers from here on are no frames.
inline constexpr std::uint32_t kWholeClip = 0xFFFFFF00U;

}  // namespace vesalius::synth
