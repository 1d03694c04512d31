#include "synth/scene/place_people.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/scene/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

/// Returns half the angle about the vertical within which a camera sees the floor, with a margin for people at the
/// border.
float half_fan(const Camera& camera, float pitch_rad) {
  const float half_u = std::atan(0.5F * static_cast<float>(camera.width) / camera.fx);
  const float half_v = std::atan(0.5F * static_cast<float>(camera.height) / camera.fy);
  if (std::abs(pitch_rad) + half_v > 0.48F * kPi) return kPi;
  return std::min(kPi, 1.15F * std::atan2(std::tan(half_u), std::cos(std::abs(pitch_rad) + half_v)));
}

/// Returns the share of the bones' ends that are in the picture.
float visible_share(const BodyOutline& body, const View& view) {
  int seen = 0;
  for (const Capsule& bone : body.bones) {
    for (const Vector3f& end : {bone.from, bone.to}) {
      const Vector3f p = view.camera_from_world * end;
      if (p.z() < 0.1F) continue;
      const Eigen::Vector2f pixel = view.camera.pixel(p);
      seen += pixel.x() > 0.F && pixel.y() > 0.F && pixel.x() < static_cast<float>(view.camera.width - 1) &&
                      pixel.y() < static_cast<float>(view.camera.height - 1)
                  ? 1
                  : 0;
    }
  }
  return static_cast<float>(seen) / (2.F * static_cast<float>(kBoneCount));
}

Vector3f middle_of(const PeopleGroup& group) {
  Eigen::AlignedBox3f bounds;
  for (const GroupMember& member : group.members) bounds.extend(member.outline.bounds);
  return bounds.center();
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
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      constexpr int kCameras = 5;
      bool placed = place(static_cast<int>(g));
      for (int i = 1; i < kCameras && !placed && stage_.groups.empty(); ++i) {
        hold_camera(middle_of(groups_[g]).y());  // nobody is in view yet, so the camera is drawn anew
        placed = place(static_cast<int>(g));
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
    constexpr int kTries = 24;
    for (int i = 0; i < kTries; ++i) {
      const Isometry3f world_from_group = draw_place(groups_[g]);
      if (accept(groups_[g], world_from_group)) {
        stage_.groups.push_back({g, world_from_group});
        return true;
      }
    }
    return false;
  }

  float draw_heading(const PeopleGroup& group) {
    const std::optional<float>& given = plans_[group.members[0].plan].yaw_rad;
    if (given) return *given;
    const double frontal = options_.frontal_range_deg * std::numbers::pi / 180.0;
    return chance(options_.frontal_share, random_) ? between(-frontal, frontal, random_) : between(-kPi, kPi, random_);
  }

  Isometry3f draw_place(const PeopleGroup& group) {
    const Vector3f middle = middle_of(group);
    const float rise = stage_.camera.height_m - middle.y();
    const float far = sample_distance(placement_, random_);
    // If the distance is less than the height, the place is straight below the camera.
    const float along = std::sqrt(std::max(0.F, far * far - rise * rise)) + between(0.0, 0.3, random_);
    const float fan = half_fan(view_.camera, stage_.camera.pitch_rad);
    const float bearing = between(-fan, fan, random_);
    const Vector3f at(along * std::sin(bearing), 0.F, -along * std::cos(bearing));
    const float to_camera = std::atan2(-at.x(), -at.z());
    const Isometry3f turned = standing_at(0.F, 0.F, 0.F, to_camera + draw_heading(group));
    return Eigen::Translation3f(at) * turned * Eigen::Translation3f(-middle.x(), 0.F, -middle.z());
  }

  bool accept(const PeopleGroup& group, const Isometry3f& world_from_group) {
    std::vector<BodyOutline> bodies;
    for (const GroupMember& member : group.members) {
      bodies.push_back(moved(member.outline, world_from_group));
      if (visible_share(bodies.back(), view_) < options_.min_visible) return false;
      if (!stage_.occupancy.free_for(bodies.back())) return false;
    }
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
  Stage stage_;
};

}  // namespace

Stage place_people(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                   const std::vector<PersonPlan>& plans, const std::vector<PeopleGroup>& groups, Random& random) {
  return Placer(options, placement, intrinsics, plans, groups, random).run();
}

}  // namespace vesalius::synth
