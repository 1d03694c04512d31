#pragma once

#include <string>

#include "synth/dress/outfit.h"
#include "synth/mocap/motion_list.h"
#include "synth/mocap/pose_library.h"
#include "synth/pose/pose_sampler.h"
#include "synth/scene/build_scene.h"
#include "synth/scene/camera_pose.h"
#include "synth/sensor/sensor.h"

namespace vesalius::synth {

/// How many people are in a picture: weights, of any sum above 0.
struct PeopleOptions {
  float none = 0.08F, one = 0.57F, two = 0.23F, three = 0.08F, four = 0.04F;
  float cut_out = 0.F;  ///< share of pictures with people from which all else is taken away
};

struct BodyOptions {
  std::string kind = "auto";  ///< makehuman, builtin, or auto: makehuman where its files are there
  int count = 300;            ///< different bodies, each dressed once
};

struct PoseOptions {
  float captured = 0.6F;  ///< share of poses from motion capture; see asks_for_motions()
  float mixed = 0.25F;    ///< share of those with limbs of another pose
  float mirrored = 0.5F;  ///< share seen in a mirror
  std::string include;    ///< words separated by commas, one of which a motion's description must have; empty: all
  std::string exclude = default_exclusions();  ///< none of which it may have
  PoseLibraryOptions library;
  PoseSamplerOptions sampler;

  static std::string default_exclusions();
};

struct SensorOptions {
  std::string preset = "kinect-v1";
  int width = 0, height = 0;                       ///< pixels; 0: the preset's
  float fx = 0.F, fy = 0.F, cx = -1.F, cy = -1.F;  ///< pixels at that size; fx 0, cx, cy < 0: the preset's
  bool noise = true;
  bool colour = true;
};

/// Everything that decides what synthetic frames look like (section 4.1). With a seed and the files of `Assets` it
/// fixes every byte of every frame.
struct Recipe {
  std::string mounting = "room";  ///< sets the camera's options: room, ceiling or wheelchair
  SensorOptions sensor;
  PeopleOptions people;
  BodyOptions body;
  OutfitOptions outfit;
  PoseOptions pose;
  CameraPlacement camera;
  SceneOptions scene;
};

void visit_options(const std::string& prefix, Recipe& recipe, OptionVisitor& visitor);

/// Throws UsageError naming the first option out of its range, or whose word is not one of those allowed.
void check(const Recipe& recipe);

/// Returns whether a recipe says anything about captured poses: a share of them other than the default's, or which
/// motions they come from. Frames of such a recipe cannot be made without motions. The default takes captured poses
/// where there are any.
bool asks_for_motions(const PoseOptions& options);

/// Which motions a recipe takes its captured poses from.
MotionChoice motion_choice(const PoseOptions& options);

/// The sensor that a recipe means: its preset at the size and with the intrinsics asked for.
Sensor sensor_of(const SensorOptions& options);

}  // namespace vesalius::synth
