#include "ros2/messages/human_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace vesalius::ros2 {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

/// Directions nearer to each other than this (as a sine) say nothing about a third.
constexpr float kLeastSine = 0.2F;

std::optional<Vector3f> direction(const std::optional<Vector3f>& from, const std::optional<Vector3f>& to) {
  constexpr float kLeast_m = 0.01F;
  if (!from || !to || (*to - *from).norm() < kLeast_m) return std::nullopt;
  return (*to - *from).normalized();
}

/// Returns the axes with this z, and y as near to `left` as that allows; nothing if both are nearly one.
std::optional<Matrix3f> axes(const Vector3f& up, const Vector3f& left) {
  const Vector3f forward = left.cross(up);
  if (forward.norm() < kLeastSine) return std::nullopt;
  Matrix3f all;
  all.col(2) = up;
  all.col(0) = forward.normalized();
  all.col(1) = up.cross(all.col(0));
  return all;
}

/// An arm or a leg.
struct Limb {
  std::string_view root, middle, end;
  float bends;  ///< 1 if its end turns to the front (arms), -1 if to the back
};
constexpr std::array<Limb, 4> kLimbs{{{"l_shoulder", "l_elbow", "l_wrist", 1.F},
                                      {"r_shoulder", "r_elbow", "r_wrist", 1.F},
                                      {"l_hip", "l_knee", "l_ankle", -1.F},
                                      {"r_hip", "r_knee", "r_ankle", -1.F}}};

class Frames {
 public:
  Frames(const TrackedPerson& person, const NamedJoints& joints, const std::string& id, const std::string& camera_frame)
      : person_(person), joints_(joints), id_(id), camera_frame_(camera_frame) {}

  std::vector<FrameTransform> all(const Vector3f& up) {
    std::optional<Vector3f> waist = place("pelvis");
    if (!waist) waist = joints_.middle(person_, "l_hip", "r_hip");
    const std::optional<Vector3f> torso = joints_.middle(person_, "l_shoulder", "r_shoulder");
    const Vector3f origin = waist.value_or(person_.position);
    body_axes_ = trunk_axes(direction(waist, torso).value_or(up), origin);
    body_.translation() = origin.cast<double>();
    body_.linear() = rotation(body_axes_);
    frames_.push_back({camera_frame_, name("body"), body_});
    add("waist", waist, body_axes_);
    add("torso", torso, body_axes_);
    add("head", place("head"), body_axes_);
    for (const Limb& limb : kLimbs) add(limb);
    return std::move(frames_);
  }

 private:
  static Eigen::Matrix3d rotation(const Matrix3f& axes) {
    return Eigen::Quaterniond(axes.cast<double>()).normalized().toRotationMatrix();
  }
  std::string name(std::string_view link) const { return fmt::format("{}_{}", link, id_); }

  std::optional<Vector3f> place(std::string_view joint) const {
    const std::optional<Joint> found = joints_.find(person_, joint);
    return found ? std::optional(found->position) : std::nullopt;
  }

  /// Returns the axes of the trunk. Who shows neither shoulders nor hips is taken to face the camera.
  Matrix3f trunk_axes(const Vector3f& up, const Vector3f& origin) const {
    for (const char* joint : {"shoulder", "hip"}) {
      const auto left = direction(place(fmt::format("r_{}", joint)), place(fmt::format("l_{}", joint)));
      if (!left) continue;
      if (const auto found = axes(up, *left)) return *found;
    }
    const Vector3f to_camera = origin.norm() > 0.F ? Vector3f(-origin.normalized()) : Vector3f(0.F, 0.F, -1.F);
    if (const auto found = axes(up, up.cross(to_camera))) return *found;
    return *axes(up, up.unitOrthogonal());
  }

  void add(std::string_view link, const std::optional<Vector3f>& at, const Matrix3f& of_axes) {
    if (!at) return;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = at->cast<double>();
    pose.linear() = rotation(of_axes);
    frames_.push_back({name("body"), name(link), body_.inverse() * pose});
  }

  void add(const Limb& limb) {
    const std::optional<Vector3f> root = place(limb.root), middle = place(limb.middle), end = place(limb.end);
    const std::optional<Vector3f> upper = direction(middle, root), lower = direction(end, middle);
    // Where it is bent it says itself about what it turns, otherwise it has the trunk's left.
    Vector3f left = body_axes_.col(1);
    if (upper && lower) {
      const Vector3f normal = upper->cross(*lower);
      if (normal.norm() > kLeastSine) left = -limb.bends * normal.normalized();
    }
    const auto axes_of = [&](const std::optional<Vector3f>& up) {
      if (!up) return body_axes_;
      if (const auto found = axes(*up, left)) return *found;
      // It points to the side: then it is the trunk's front that stays.
      return *axes(*up, up->cross(body_axes_.col(0)));
    };
    const Matrix3f upper_axes = axes_of(upper), lower_axes = lower ? axes_of(lower) : upper_axes;
    add(limb.root, root, upper_axes);
    add(limb.middle, middle, lower_axes);
    add(limb.end, end, lower_axes);
  }

  const TrackedPerson& person_;
  const NamedJoints& joints_;
  const std::string& id_;
  const std::string& camera_frame_;
  Matrix3f body_axes_ = Matrix3f::Identity();
  Eigen::Isometry3d body_ = Eigen::Isometry3d::Identity();
  std::vector<FrameTransform> frames_;
};

}  // namespace

std::vector<FrameTransform> human_frames(const TrackedPerson& person, const NamedJoints& joints, const std::string& id,
                                         const std::string& camera_frame, const Eigen::Vector3f& up) {
  return Frames(person, joints, id, camera_frame).all(up);
}

NamedJoints::NamedJoints(const BodyModel& body) : body_(body), sets_(body.joint_sets.size()) {
  std::iota(sets_.begin(), sets_.end(), std::size_t{0});
  std::stable_partition(sets_.begin(), sets_.end(),
                        [&](std::size_t set) { return body.joint_sets[set].name == "k4abt32"; });
}

std::optional<Joint> NamedJoints::find(const TrackedPerson& person, std::string_view name) const {
  const auto& joints = person.smoothed.empty() ? person.person.joints : person.smoothed;
  for (const std::size_t set : sets_) {
    if (set >= joints.size()) continue;
    const auto& names = body_.joint_sets[set].joints;
    const auto found = std::ranges::find(names, name, &JointDefinition::name);
    if (found == names.end()) continue;
    const Joint& joint = joints[set][static_cast<std::size_t>(found - names.begin())];
    if (joint.state != State::none) return joint;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector3f> NamedJoints::middle(const TrackedPerson& person, std::string_view a,
                                                   std::string_view b) const {
  const std::optional<Joint> left = find(person, a), right = find(person, b);
  if (!left || !right) return std::nullopt;
  return 0.5F * (left->position + right->position);
}

}  // namespace vesalius::ros2
