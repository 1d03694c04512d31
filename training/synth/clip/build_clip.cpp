#include "synth/clip/build_clip.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/clip/stroll.h"
#include "synth/mesh/palette.h"
#include "synth/pose/judge_pose.h"
#include "synth/scene/people_group.h"
#include "synth/scene/person_plan.h"
#include "synth/scene/place_people.h"
#include "synth/scene/surroundings.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kLook_s = 1.F / 6.F;  ///< time between two looks at whether bodies touch something
constexpr std::size_t kOutlineStride = 9;

std::vector<BodyOutline> outlines_of(const Poser& poser, const PersonTrack& track, float seconds) {
  std::vector<BodyOutline> outlines;
  for (float t = 0.F; t <= seconds; t += kLook_s) {
    outlines.push_back(outline_of(body_at(poser, track, t), poser.mesh().stature_m, kOutlineStride));
  }
  return outlines;
}

/// Returns the track of a movement that is played once, some time after the beginning, and back if the person `rises`.
PersonTrack track_of(const Movement& movement, float leg_m, const Vector2f& at, float heading_rad, float delay_s,
                     float seconds, bool rises = false) {
  constexpr float kRest_s = 1.5F, kSlower = 0.5F;  // who fell gets up with care
  const BodyState& first = movement.states.front();
  const float about = heading_rad - first.heading_rad;
  PersonTrack track;
  for (int i = 0; i < track_length(seconds); ++i) {
    float time_s = std::max(0.F, float(i) / kTrackRate_hz - delay_s);
    const float rested_s = time_s - movement.seconds() - kRest_s;
    if (rises && rested_s > 0.F) time_s = std::max(0.F, movement.seconds() - kSlower * rested_s);
    const BodyState state = state_at(movement, time_s);
    const Vector2f way = leg_m * (state.root - first.root);
    track.states.push_back({state.pose, at + way.x() * left_of(about) + way.y() * front_of(about),
                            heading_rad + state.heading_rad - first.heading_rad});
  }
  return track;
}

class Builder {
 public:
  Builder(const ClipOptions& options, const SceneOptions& scene, const CameraPlacement& placement,
          const Camera& intrinsics, const std::vector<ClipPersonPlan>& plans, float seconds, Random& random)
      : options_(options),
        scene_(scene),
        placement_(placement),
        plans_(plans),
        seconds_(seconds),
        random_(random),
        tracks_(plans.size()),
        outlines_(plans.size()) {
    ground_.view.camera = intrinsics;
  }

  ClipScene run() {
    place_sitters();
    moves_ = asked(options_.moving_share, random_) && options_.cameras == 1;
    ground_.camera_reach_m = moves_ ? kCameraReach_m : 0.F;
    ground_.view.camera_from_world = stage_.camera.world_from_camera().inverse();
    ground_.solids = stage_.occupancy.solids();
    place_movers();
    ClipScene clip = with_people();
    clip.camera = camera_of(clip);
    surround(clip);
    return clip;
  }

 private:
  /// Puts the people who stay put into the camera's view, with their seats and beds.
  void place_sitters() {
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      if (!plans_[i].stays_put) continue;
      sitters_.push_back(plans_[i].person);
      plan_of_.push_back(i);
    }
    SceneOptions still = scene_;
    still.load_probability = still.contact_probability = 0.F;  // hands move on
    groups_ = make_groups(still, sitters_, random_);
    stage_ = place_people(scene_, placement_, ground_.view.camera, sitters_, groups_, random_);
    if (stage_.groups.empty()) hold_camera();
    for (const PlacedGroup& placed : stage_.groups) {
      for (const GroupMember& member : groups_[placed.group].members) {
        settle(plan_of_[member.plan], member.body, placed.world_from_group * member.group_from_body);
      }
    }
  }

  /// Aims the camera at where people will walk, so that it sees most of a person at a usual distance.
  void hold_camera() {
    constexpr int kTries = 12;
    for (int i = 0; i < kTries; ++i) {
      const float far = std::max(sample_distance(placement_, random_), placement_.usual_min_m);
      stage_.camera = sample_camera(placement_, between(0.7, 1.1, random_), far, random_);
      if (sees_person(stage_.camera)) break;
    }
    stage_.occupancy.set_eye({0.F, stage_.camera.height_m, 0.F});
  }

  /// Returns how far from the camera the middle of the usual distances is, along the ground.
  float middle_m(const CameraPose& pose) const {
    const float far = 0.5F * (placement_.usual_min_m + placement_.usual_max_m), rise = pose.height_m - 0.95F;
    return std::sqrt(std::max(0.F, far * far - rise * rise));
  }

  /// Returns the pose of a camera, world from camera: that of the first, turned about the middle of the scene.
  Isometry3f pose_of(int camera) const {
    const Vector3f middle(0.F, 0.F, -middle_m(stage_.camera));
    const Eigen::AngleAxisf turn(float(camera) * options_.apart_deg * kPi / 180.F, Vector3f::UnitY());
    const Isometry3f about = Eigen::Translation3f(middle) * turn * Eigen::Translation3f(-middle);
    return camera == 0 ? stage_.camera.world_from_camera() : about * stage_.camera.world_from_camera();
  }

  /// Returns whether knees and head of somebody in the middle of the usual distances are in the picture.
  bool sees_person(const CameraPose& pose) const {
    const Camera& camera = ground_.view.camera;
    const float along = middle_m(pose);
    const Isometry3f camera_from_world = pose.world_from_camera().inverse();
    for (const float y : {0.5F, 1.65F}) {
      const Vector3f p = camera_from_world * Vector3f(0.F, y, -along);
      if (p.z() < 0.1F) return false;
      const Vector2f pixel = camera.pixel(p);
      if (pixel.x() < 0.F || pixel.x() > float(camera.width)) return false;
      if (pixel.y() < 0.F || pixel.y() > float(camera.height)) return false;
    }
    return true;
  }

  /// Gives somebody who stays put a track, and stills the arms where they would touch something.
  void settle(std::size_t plan, const PosedBody& body, const Isometry3f& world_from_body) {
    const Vector3f at = world_from_body.translation();
    const Vector3f front = world_from_body.linear().col(2);
    const float heading = std::atan2(front.x(), front.z());
    PersonTrack track = track_of(plans_[plan].fidget, 1.F, {at.x(), at.z()}, heading, 0.F, seconds_);
    track.pelvis_m = (world_from_body * body.joints[index(Bone::pelvis)]).y();
    const Poser& poser = *plans_[plan].person.poser;
    const auto touches = [&](const BodyOutline& o) { return sinks_in(o, stage_.occupancy.solids()); };
    std::vector<BodyOutline> outlines;
    if (plans_[plan].sits_down) {
      PersonTrack moving = with_seating(plans_[plan], track);
      outlines = outlines_of(poser, moving, seconds_);
      if (is_free(outlines)) {
        add_footprint(outlines.back());
        return settle(plan, std::move(moving), std::move(outlines));
      }
    }
    outlines = outlines_of(poser, track, seconds_);
    if (std::ranges::any_of(outlines, touches)) {
      for (TrackState& state : track.states) state.pose = plans_[plan].person.pose;
      outlines = outlines_of(poser, track, seconds_);
    }
    settle(plan, std::move(track), std::move(outlines));
  }

  void settle(std::size_t plan, PersonTrack track, std::vector<BodyOutline> outlines) {
    add_footprint(outlines.front());
    take(plan, std::move(track), std::move(outlines));
  }

  /// Keeps others from the floor below a body.
  void add_footprint(const BodyOutline& outline) {
    std::vector<Vector2f>& footprint = ground_.footprints.emplace_back();
    for (const Capsule& bone : outline.bones) footprint.emplace_back(bone.from.x(), bone.from.z());
  }

  /// Returns the track of somebody who comes to a seat, or leaves it, in the middle of the clip. `seated` is the track
  /// of the same person who remains there.
  PersonTrack with_seating(const ClipPersonPlan& plan, const PersonTrack& seated) {
    const Movement& movement = *plan.sits_down;
    const bool rises = chance(0.5, random_);
    const float begins_s = between(0.2, 0.6, random_) * std::max(0.F, seconds_ - movement.seconds());
    const Vector2f way = movement.states.back().root;
    PersonTrack track = seated;
    for (std::size_t i = 0; i < track.states.size(); ++i) {
      const float since_s = float(i) / kTrackRate_hz - begins_s;
      const float time_s = rises ? movement.seconds() - since_s : since_s;
      if (time_s >= movement.seconds()) continue;  // on the seat
      const BodyState state = state_at(movement, std::max(0.F, time_s));
      const Vector2f off = plan.can.leg_m * (state.root - way);
      TrackState& now = track.states[i];
      now.pose = state.pose;
      now.at += off.x() * left_of(now.heading_rad) + off.y() * front_of(now.heading_rad);
      const float share = std::max(0.F, time_s) / movement.seconds();
      now.seated = share * share * (3.F - 2.F * share);
    }
    return track;
  }

  void take(std::size_t plan, PersonTrack track, std::vector<BodyOutline> outlines) {
    ground_.people.push_back(track);
    tracks_[plan] = std::move(track);
    outlines_[plan] = std::move(outlines);
  }

  void place_movers() {
    const bool crosses = chance(options_.crossing_share, random_);
    std::vector<std::size_t> order;  // who stands comes first, so that others find a way about them
    for (const bool walks : {false, true}) {
      for (std::size_t i = 0; i < plans_.size(); ++i) {
        if (!plans_[i].stays_put && (plans_[i].walks && !plans_[i].lies_down) == walks) order.push_back(i);
      }
    }
    for (const std::size_t i : order) place_mover(i, crosses);
  }

  void place_mover(std::size_t plan, bool crosses) {
    constexpr int kTries = 5;
    const ClipPersonPlan& p = plans_[plan];
    for (int i = 0; i < kTries; ++i) {
      std::optional<PersonTrack> track = p.lies_down ? lie_down(p)
                                                     : plan_stroll(options_, placement_, ground_, p.can,
                                                                   {p.walks, crosses && p.walks}, seconds_, random_);
      if (!track) continue;
      std::vector<BodyOutline> outlines = outlines_of(*p.person.poser, *track, seconds_);
      if (!is_free(outlines)) continue;
      return take(plan, std::move(*track), std::move(outlines));
    }
  }

  PersonTrack lie_down(const ClipPersonPlan& plan) {
    const float rise = stage_.camera.height_m - 0.5F, far = sample_distance(placement_, random_);
    const float along = std::sqrt(std::max(0.F, far * far - rise * rise)) + 0.3F;
    const Camera& camera = ground_.view.camera;
    const float half_fan = std::atan(0.5F * float(camera.width) / camera.fx);
    const float bearing = between(-0.7, 0.7, random_) * half_fan, heading = between(-kPi, kPi, random_);
    const float delay = between(0.0, 0.3, random_) * seconds_;
    return track_of(*plan.lies_down, plan.can.leg_m, {along * std::sin(bearing), -along * std::cos(bearing)}, heading,
                    delay, seconds_, asked(options_.rising_share, random_));
  }

  /// Returns whether a person is apart from the camera, all seats and beds, and at all times from all others.
  bool is_free(const std::vector<BodyOutline>& outlines) const {
    for (std::size_t t = 0; t < outlines.size(); ++t) {
      if (sinks_in(outlines[t], stage_.occupancy.solids())) return false;
      const float clear_m = 0.25F + ground_.camera_reach_m;
      for (int i = 0; i < options_.cameras; ++i) {
        const Vector3f eye = pose_of(i).translation();
        if (outlines[t].bounds.squaredExteriorDistance(eye) < clear_m * clear_m) return false;
      }
      for (const std::vector<BodyOutline>& other : outlines_) {
        if (!other.empty() && sinks_in(outlines[t], other[t])) return false;
      }
    }
    return true;
  }

  ClipScene with_people() const {
    ClipScene clip;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      if (!tracks_[i].states.empty()) clip.people.push_back({plans_[i].person, tracks_[i]});
    }
    return clip;
  }

  CameraTrack camera_of(const ClipScene& clip) const {
    if (!moves_) return {{pose_of(options_.seen_from)}};
    std::vector<PersonTrack> tracks;
    for (const ClipPerson& person : clip.people) tracks.push_back(person.track);
    return move_camera(options_, stage_.camera, seconds_, tracks, random_);
  }

  /// Builds room and furniture about everything that moves.
  void surround(ClipScene& clip) {
    std::vector<Vector3f> eyes;
    for (int i = 0; i < options_.cameras && !moves_; ++i) eyes.emplace_back(pose_of(i).translation());
    for (float t = 0.F; moves_ && t <= seconds_; t += 0.5F) eyes.emplace_back(clip.camera.at(t).translation());
    const PlacedGroup* first = stage_.groups.empty() ? nullptr : stage_.groups.data();
    clip.room = draw_room(
        scene_, first, [&](const Isometry3f& room_from_world) { return extent_of(eyes, room_from_world); }, random_);
    Occupancy& occupancy = stage_.occupancy;
    occupancy.set_room(clip.room);
    occupancy.set_eyes(eyes);
    std::vector<Vector3f> chests;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      if (outlines_[i].empty()) continue;
      chests.push_back(outlines_[i][outlines_[i].size() / 2].bones[index(Bone::chest)].from);
      occupancy.add(std::move(outlines_[i]));
    }
    Scene& scene = clip.surroundings;
    scene.meshes.push_back(make_room(clip.room, random_));
    for (const PlacedGroup& placed : stage_.groups) {
      for (Furniture& piece : groups_[placed.group].furniture) {
        move(piece, placed.world_from_group);
        scene.meshes.push_back(std::move(piece.mesh));
      }
    }
    furnish(scene_, clip.room, chests, eyes.front(), occupancy, scene, random_);
    clip.solids = occupancy.solids();
  }

  Eigen::AlignedBox3f extent_of(const std::vector<Vector3f>& eyes, const Isometry3f& room_from_world) const {
    constexpr float kEyeClear_m = 0.2F, kBodyClear_m = 0.1F;  // bodies move on between two looks
    Eigen::AlignedBox3f extent;
    const auto include = [&](const Vector3f& p, float clear_m) {
      extent.extend(room_from_world * p + Vector3f(clear_m, 0.F, clear_m));
      extent.extend(room_from_world * p - Vector3f(clear_m, 0.F, clear_m));
    };
    for (const Vector3f& eye : eyes) include(eye, kEyeClear_m);
    for (const std::vector<BodyOutline>& person : outlines_) {
      for (const BodyOutline& outline : person) {
        for (const Vector3f& p : outline.points) include(p, kBodyClear_m);
      }
    }
    for (const PlacedGroup& placed : stage_.groups) {
      for (const Furniture& piece : groups_[placed.group].furniture) {
        for (const Vector3f& p : piece.mesh.vertices) include(placed.world_from_group * p, 0.F);
      }
    }
    return extent;
  }

  const ClipOptions& options_;
  const SceneOptions& scene_;
  const CameraPlacement& placement_;
  const std::vector<ClipPersonPlan>& plans_;
  float seconds_;
  Random& random_;
  bool moves_ = false;
  std::vector<PersonPlan> sitters_;
  std::vector<std::size_t> plan_of_;  ///< [sitter]
  std::vector<PeopleGroup> groups_;
  Stage stage_;
  StrollGround ground_;
  std::vector<PersonTrack> tracks_;                 ///< [plan]; without states where there was no room
  std::vector<std::vector<BodyOutline>> outlines_;  ///< [plan][look]
};

}  // namespace

ClipScene build_clip(const ClipOptions& options, const SceneOptions& scene, const CameraPlacement& placement,
                     const Camera& intrinsics, const std::vector<ClipPersonPlan>& plans, float seconds, Random random) {
  check(scene);
  check(placement);
  vesalius::check(intrinsics);
  return Builder(options, scene, placement, intrinsics, plans, seconds, random).run();
}

BuiltScene scene_at(const ClipScene& clip, const Camera& intrinsics, float detail_px, float time_s) {
  BuiltScene built;
  built.view = {intrinsics, clip.camera.at(time_s).inverse()};
  built.scene = clip.surroundings;
  built.room = clip.room;
  built.solids = clip.solids;
  for (std::size_t i = 0; i < clip.people.size(); ++i) {
    const ClipPerson& person = clip.people[i];
    PlacedPerson placed;
    placed.body = body_at(*person.person.poser, person.track, time_s);
    placed.plan = int(i);
    placed.posture = classify_posture(person.track.at(time_s).pose);
    placed.mesh = int(built.scene.meshes.size());
    SceneMesh mesh = person_mesh(person.person, placed.body, built.view, detail_px);
    mesh.person = int(i);
    built.scene.meshes.push_back(std::move(mesh));
    built.people.push_back(std::move(placed));
  }
  return built;
}

}  // namespace vesalius::synth
