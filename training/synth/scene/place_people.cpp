#include "synth/scene/place_people.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

/// Returns half the angle about the vertical within which a camera sees the floor, with a margin for people at the
/// border.
float half_fan(const Camera& camera, float pitch_rad) {
  const float half_u = std::atan(0.5F * float(camera.width) / camera.fx);
  const float half_v = std::atan(0.5F * float(camera.height) / camera.fy);
  if (std::abs(pitch_rad) + half_v > 0.48F * kPi) return kPi;
  return std::min(kPi, 1.15F * std::atan2(std::tan(half_u), std::cos(std::abs(pitch_rad) + half_v)));
}

/// The share of the bones of somebody whom a border cuts that remains in the picture.
constexpr float kCutVisible = 1.F / 7.F;

/// The shares of the bones' ends that are in the picture, and beside it to the left or right.
struct Visible {
  float inside = 0.F, beside = 0.F;
};

Visible visible_share(const BodyOutline& body, const View& view) {
  int seen = 0, beside = 0;
  for (const Capsule& bone : body.bones) {
    for (const Vector3f& end : {bone.from, bone.to}) {
      const Vector3f p = view.camera_from_world * end;
      if (p.z() < 0.1F) continue;
      const Eigen::Vector2f pixel = view.camera.pixel(p);
      beside += pixel.x() < 0.F || pixel.x() > float(view.camera.width - 1) ? 1 : 0;
      seen += pixel.x() > 0.F && pixel.y() > 0.F && pixel.x() < float(view.camera.width - 1) &&
                      pixel.y() < float(view.camera.height - 1)
                  ? 1
                  : 0;
    }
  }
  constexpr float kEnds = 2.F * float(kBoneCount);
  return {float(seen) / kEnds, float(beside) / kEnds};
}

Vector3f middle_of(const PeopleGroup& group) {
  Eigen::AlignedBox3f bounds;
  for (const GroupMember& member : group.members) bounds.extend(member.outline.bounds);
  return bounds.center();
}

std::vector<BodyOutline> moved_bodies(const PeopleGroup& group, const Isometry3f& world_from_group) {
  std::vector<BodyOutline> bodies;
  for (const GroupMember& member : group.members) bodies.push_back(moved(member.outline, world_from_group));
  return bodies;
}

class Placer {
 public:
  Placer(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
         const std::vector<PersonPlan>& plans, const std::vector<PeopleGroup>& groups, Random& random)
      : options_(options), placement_(placement), plans_(plans), groups_(groups), random_(random) {
    view_.camera = intrinsics;
  }

  Stage run() {
    const float usual_height = between(0.3, 1.5, random_);
    hold_camera(groups_.empty() ? usual_height : middle_of(groups_[0]).y());
    cuts_ = asked(options_.cut_share, random_);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      constexpr int kCameras = 5;
      bool placed = place(int(g));
      for (int i = 1; i < kCameras && !placed && stage_.groups.empty(); ++i) {
        hold_camera(middle_of(groups_[g]).y());  // nobody is in view yet, so the camera is drawn anew
        placed = place(int(g));
      }
    }
    return std::move(stage_);
  }

 private:
  void hold_camera(float target_height) {
    const float off = between(-0.3, 0.3, random_);
    stage_.camera = sample_camera(placement_, target_height + off, sample_distance(placement_, random_), random_);
    view_.camera_from_world = stage_.camera.world_from_camera().inverse();
    stage_.occupancy.set_eye({0.F, stage_.camera.height_m, 0.F});
  }

  bool place(int g) {
    constexpr int kTries = 24, kTriesAtBorder = 18;
    const bool at_border = asked(options_.border_share, random_);
    for (int i = 0; i < kTries; ++i) {
      const bool cut = at_border && i < kTriesAtBorder;
      const Isometry3f world_from_group = draw_place(groups_[g], cut);
      if (accept(groups_[g], world_from_group, cut)) {
        if (cuts_ && stage_.groups.empty()) tilt(moved_bodies(groups_[g], world_from_group));
        stage_.groups.push_back({g, world_from_group});
        return true;
      }
    }
    return false;
  }

  /// Tilts the camera so that its borders cut somebody of the first group, if tilts within the limits can.
  void tilt(const std::vector<BodyOutline>& bodies) {
    constexpr int kTries = 16;
    constexpr float kMostVisible = 0.75F, kRadPerDeg = kPi / 180.F;
    CameraPose tilted = stage_.camera;
    View view = view_;
    for (int i = 0; i < kTries; ++i) {
      tilted.pitch_rad = kRadPerDeg * between(placement_.pitch_min_deg, placement_.pitch_max_deg, random_);
      view.camera_from_world = tilted.world_from_camera().inverse();
      float least = 1.F;
      for (const BodyOutline& body : bodies) least = std::min(least, visible_share(body, view).inside);
      if (least < kCutVisible || least > kMostVisible) continue;
      stage_.camera = tilted;
      view_ = view;
      return;
    }
  }

  float draw_heading(const PeopleGroup& group) {
    const std::optional<float>& given = plans_[group.members[0].plan].yaw_rad;
    if (given) return *given;
    const double frontal = options_.frontal_range_deg * std::numbers::pi / 180.0;
    return chance(options_.frontal_share, random_) ? between(-frontal, frontal, random_) : between(-kPi, kPi, random_);
  }

  /// Draws the angle from the view's middle, or from about its border, from where one sees a group.
  float draw_bearing(bool at_border) {
    const float fan = half_fan(view_.camera, stage_.camera.pitch_rad);
    if (!at_border) return between(-fan, fan, random_);
    const float half_u = std::atan(0.5F * float(view_.camera.width) / view_.camera.fx);
    return (chance(0.5, random_) ? 1.F : -1.F) * std::min(fan, half_u * between(0.75, 1.25, random_));
  }

  Isometry3f draw_place(const PeopleGroup& group, bool at_border) {
    const Vector3f middle = middle_of(group);
    const float rise = stage_.camera.height_m - middle.y();
    const bool close = cuts_ && stage_.groups.empty() && chance(0.4, random_);
    const float far =
        close ? placement_.distance_min_m + between(0.0, 0.4, random_) : sample_distance(placement_, random_);
    // If the distance is less than the height, the place is straight below the camera.
    const float along = std::sqrt(std::max(0.F, far * far - rise * rise)) + between(0.0, 0.3, random_);
    const float bearing = draw_bearing(at_border);
    const Vector3f at(along * std::sin(bearing), 0.F, -along * std::cos(bearing));
    const float to_camera = std::atan2(-at.x(), -at.z());
    const Isometry3f turned = standing_at(0.F, 0.F, 0.F, to_camera + draw_heading(group));
    return Eigen::Translation3f(at) * turned * Eigen::Translation3f(-middle.x(), 0.F, -middle.z());
  }

  /// Takes a place if it is free and enough of everybody is in the picture, and adds what stands there. At the border,
  /// it must cut somebody.
  bool accept(const PeopleGroup& group, const Isometry3f& world_from_group, bool at_border) {
    constexpr float kLeastCut = 0.15F;
    float cut = 0.F;
    const bool first = cuts_ && stage_.groups.empty();
    const float least = first ? std::min(kCutVisible, options_.min_visible) : options_.min_visible;
    const std::vector<BodyOutline> bodies = moved_bodies(group, world_from_group);
    for (const BodyOutline& body : bodies) {
      const Visible visible = visible_share(body, view_);
      if (visible.inside < least) return false;
      cut = std::max(cut, visible.beside);
      if (!stage_.occupancy.free_for(body)) return false;
    }
    if (at_border && cut < kLeastCut) return false;
    std::vector<OrientedBox> solids;
    for (const Furniture& piece : group.furniture) {
      for (const OrientedBox& box : piece.solids) solids.push_back(moved(box, world_from_group));
    }
    if (!stage_.occupancy.free_for(solids)) return false;
    for (const BodyOutline& body : bodies) stage_.occupancy.add(body);
    stage_.occupancy.add(solids);
    return true;
  }

  const SceneOptions& options_;
  const CameraPlacement& placement_;
  const std::vector<PersonPlan>& plans_;
  const std::vector<PeopleGroup>& groups_;
  Random& random_;
  View view_;
  bool cuts_ = false;  ///< whether borders are to cut the first group
  Stage stage_;
};

}  // namespace

Stage place_people(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                   const std::vector<PersonPlan>& plans, const std::vector<PeopleGroup>& groups, Random& random) {
  return Placer(options, placement, intrinsics, plans, groups, random).run();
}

}  // namespace vesalius::synth
