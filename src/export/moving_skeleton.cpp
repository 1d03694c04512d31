#include "export/moving_skeleton.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string_view>
#include <utility>

#include "stream/json_numbers.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {
namespace {

/// Returns the name of a bone in animation programs; its own where they have none.
std::string mixamo_name(const std::string& bone) {
  constexpr std::array<std::string_view, 24> kNames{"pelvis",    "Hips",  "spine",   "Spine",   "chest",    "Spine1",
                                                    "neck",      "Neck",  "head",    "Head",    "clavicle", "Shoulder",
                                                    "upper_arm", "Arm",   "forearm", "ForeArm", "hand",     "Hand",
                                                    "thigh",     "UpLeg", "shin",    "Leg",     "foot",     "Foot"};
  const bool left = bone.starts_with("l_"), right = bone.starts_with("r_");
  const auto found = std::ranges::find(kNames, std::string_view(bone).substr(left || right ? 2 : 0));
  if (found == kNames.end()) return bone;
  return (left ? "Left" : right ? "Right" : "") + std::string(*std::next(found));
}

/// From the optical frame (y down, z away) to one with y up and z towards the camera.
const Eigen::Quaterniond& upright() {
  static const Eigen::Quaterniond kTurn(0.0, 1.0, 0.0, 0.0);  // half a turn about x
  return kTurn;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

Eigen::Vector3d median(const std::vector<Eigen::Vector3d>& values) {
  Eigen::Vector3d result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> along;
    along.reserve(values.size());
    for (const Eigen::Vector3d& value : values) along.push_back(value[axis]);
    result[axis] = median(std::move(along));
  }
  return result;
}

Eigen::Quaterniond turn_of(const FittedBone& bone) { return rounded(bone.global).normalized(); }

/// Returns where a bone's head is in the frame of the bone that it hangs on.
Eigen::Vector3d offset_from(const FittedBone& parent, const FittedBone& bone) {
  return turn_of(parent).conjugate() * (rounded(bone.head) - rounded(parent.head));
}

/// The bodies of one person.
struct Bodies {
  std::size_t first = 0, last = 0;  ///< frames
  std::map<std::size_t, const FittedBody*> of_frame;
};

std::vector<MovingSkeleton::Bone> bones_of(const PeopleRecord& record, const Bodies& bodies) {
  const FleshModel& flesh = builtin_flesh();
  std::vector<MovingSkeleton::Bone> bones;
  for (std::size_t b = 0; b < record.bones.size(); ++b) {
    const int known = flesh.find_bone(record.bones[b]);
    if (known < 0) throw Error(fmt::format("a body with a bone {}, which this version does not know", record.bones[b]));
    MovingSkeleton::Bone bone;
    bone.name = mixamo_name(record.bones[b]);
    bone.flesh = known;
    const int parent = flesh.bones[known].parent;
    if (parent >= 0) {
      const auto at = std::ranges::find(record.bones, flesh.bones[parent].name);
      if (at - record.bones.begin() >= static_cast<std::ptrdiff_t>(b)) {
        throw Error(fmt::format("a body whose bone {} comes before {}", record.bones[b], flesh.bones[parent].name));
      }
      bone.parent = int(at - record.bones.begin());
      bones[bone.parent].ends = false;
    }
    std::vector<Eigen::Vector3d> offsets, tails;
    for (const auto& [unused, body] : bodies.of_frame) {
      const FittedBone& here = body->bones[b];
      tails.push_back(turn_of(here).conjugate() * (rounded(here.tail) - rounded(here.head)));
      if (bone.parent >= 0) offsets.push_back(offset_from(body->bones[bone.parent], here));
    }
    bone.tail_m = median(tails);
    if (!offsets.empty()) bone.offset_m = median(offsets);
    bones.push_back(std::move(bone));
  }
  return bones;
}

/// Returns the medians of a person's shapes, or nothing if a body has none, as of versions before.
std::vector<float> shape_of(const Bodies& bodies) {
  const auto shapes = static_cast<std::size_t>(builtin_flesh().shapes);
  std::vector<std::vector<double>> of_frames(shapes);
  for (const auto& [unused, body] : bodies.of_frame) {
    if (body->shape.empty()) return {};
    if (body->shape.size() != shapes) {
      throw Error(fmt::format("a body whose shape has {} numbers, expected {}", body->shape.size(), shapes));
    }
    for (std::size_t k = 0; k < shapes; ++k) of_frames[k].push_back(double(body->shape[k]));
  }
  std::vector<float> shape;
  for (std::vector<double>& values : of_frames) shape.push_back(float(median(std::move(values))));
  return shape;
}

MovingSkeleton::Pose pose_of(const FittedBody& fitted, const std::vector<MovingSkeleton::Bone>& bones) {
  const std::vector<FittedBone>& body = fitted.bones;
  MovingSkeleton::Pose pose;
  pose.shape = fitted.shape;
  pose.root_m = upright() * rounded(body.front().head);
  for (std::size_t b = 0; b < bones.size(); ++b) {
    if (bones[b].parent < 0) {
      pose.local.push_back(upright() * turn_of(body[b]));
      pose.offsets_m.emplace_back(Eigen::Vector3d::Zero());
      continue;
    }
    const FittedBone& parent = body[bones[b].parent];
    pose.local.push_back(turn_of(parent).conjugate() * turn_of(body[b]));
    pose.offsets_m.push_back(offset_from(parent, body[b]));
  }
  return pose;
}

}  // namespace

std::vector<MovingSkeleton> moving_skeletons(const PeopleRecord& record, std::optional<int> person) {
  std::map<int, Bodies> all;
  for (std::size_t f = 0; f < record.frames.size(); ++f) {
    for (const RecordedPerson& one : record.frames[f].people) {
      if (!one.body || one.body->bones.empty() || (person && one.id != *person)) continue;
      Bodies& bodies = all[one.id];
      if (bodies.of_frame.empty()) bodies.first = f;
      bodies.last = f;
      bodies.of_frame[f] = &*one.body;
    }
  }
  if (all.empty()) {
    throw Error(person ? fmt::format("person {} has no fitted body, expected one as detect --track fits it", *person)
                       : "nobody has a fitted body, expected some as detect --track fits them");
  }
  std::vector<MovingSkeleton> skeletons;
  for (const auto& [id, bodies] : all) {
    MovingSkeleton& skeleton = skeletons.emplace_back();
    skeleton.id = id;
    skeleton.bones = bones_of(record, bodies);
    skeleton.shape = shape_of(bodies);
    for (std::size_t f = bodies.first; f <= bodies.last; ++f) {
      const auto here = bodies.of_frame.find(f);
      if (here != bodies.of_frame.end()) {
        skeleton.poses.push_back(pose_of(*here->second, skeleton.bones));
        if (skeleton.poses.size() > 1) {
          // The same rotation as two quaternions: programs interpolate between neighbours.
          const MovingSkeleton::Pose& before = skeleton.poses[skeleton.poses.size() - 2];
          for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            Eigen::Quaterniond& now = skeleton.poses.back().local[b];
            if (before.local[b].dot(now) < 0.0) now.coeffs() = -now.coeffs();
          }
        }
      } else {
        skeleton.poses.push_back(skeleton.poses.back());
        skeleton.poses.back().there = false;
      }
      skeleton.poses.back().time_s = record.frames[f].time_s;
    }
  }
  return skeletons;
}

Eigen::Vector3d zxy_degrees(const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d r = rotation.toRotationMatrix();
  const double sine = std::clamp(r(2, 1), -1.0, 1.0);
  // Near a quarter turn about x the other two turn about the same axis: all of it is given to z.
  const bool locked = std::abs(sine) > 1.0 - 1e-9;
  const double z = locked ? std::atan2(r(1, 0), r(0, 0)) : std::atan2(-r(0, 1), r(1, 1));
  const double y = locked ? 0.0 : std::atan2(-r(2, 0), r(2, 2));
  return Eigen::Vector3d(z, std::asin(sine), y) * (180.0 / std::numbers::pi);
}

}  // namespace vesalius
