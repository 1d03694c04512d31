#pragma once

#include <optional>
#include <vector>

#include "synth/clip/clip_options.h"
#include "synth/clip/stroll.h"
#include "synth/clip/tracks.h"
#include "synth/scene/build_scene.h"

namespace vesalius::synth {

/// A person of a clip before they have a place.
struct ClipPersonPlan {
  PersonPlan person;       ///< people who sit, lie or kneel keep its pose
  bool stays_put = false;  ///< on a seat, bed or the floor, where only arms and head move
  Movement fidget;         ///< what people do who stay put; its first state has the person's pose
  Repertoire can;          ///< what the others can do
  bool walks = true;       ///< whether the others walk; false stands at one place
  /// Of the others, in place of walking: lies down on the floor, or falls, and remains there.
  std::optional<Movement> lies_down;
  /// Of people on seats: how they sit down, from standing to the person's pose.
  std::optional<Movement> sits_down;
};

struct ClipPerson {
  PersonPlan person;
  PersonTrack track;
};

/// A clip: what stands still, and who moves how.
struct ClipScene {
  Scene surroundings;  ///< room, furniture, light; no people
  RoomShape room;
  std::vector<OrientedBox> solids;  ///< furniture as boxes that were kept apart from people
  std::vector<ClipPerson> people;   ///< as far as there was room, in the order of the plans
  CameraTrack camera;
};

/// Makes a room in which people move before a camera for so many seconds. Nobody goes through furniture, walls, the
/// camera or each other: that is looked at several times a second. People who find no place or way after a bounded
/// number of tries are left out. The same arguments give the same clip. Throws UsageError for invalid options.
ClipScene build_clip(const ClipOptions& options, const SceneOptions& scene, const CameraPlacement& placement,
                     const Camera& intrinsics, const std::vector<ClipPersonPlan>& plans, float seconds, Random random);

/// Returns the scene of a clip at a time, as build_scene() gives those of single frames. The posture of each person is
/// that of the pose (classify_posture).
BuiltScene scene_at(const ClipScene& clip, const Camera& intrinsics, float detail_px, float time_s);

}  // namespace vesalius::synth
