#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "c/guard.h"
#include "c/handles.h"
#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/vesalius.h"

namespace vesalius::c {
namespace {

static_assert(int(State::none) == VESALIUS_STATE_NONE && int(State::predicted) == VESALIUS_STATE_PREDICTED &&
              int(State::observed) == VESALIUS_STATE_OBSERVED);

static_assert(int(Unseen::none) == VESALIUS_UNSEEN_NONE &&
              int(Unseen::out_of_picture) == VESALIUS_UNSEEN_OUT_OF_PICTURE &&
              int(Unseen::behind_person) == VESALIUS_UNSEEN_BEHIND_PERSON &&
              int(Unseen::behind_something) == VESALIUS_UNSEEN_BEHIND_SOMETHING &&
              int(Unseen::no_depth) == VESALIUS_UNSEEN_NO_DEPTH && int(Unseen::not_sure) == VESALIUS_UNSEEN_NOT_SURE);

static_assert(int(TrackState::seen) == VESALIUS_PERSON_SEEN && int(TrackState::fresh) == VESALIUS_PERSON_NEW &&
              int(TrackState::tracked) == VESALIUS_PERSON_TRACKED &&
              int(TrackState::hidden) == VESALIUS_PERSON_HIDDEN && int(TrackState::lost) == VESALIUS_PERSON_LOST);

static_assert(int(Stance::unknown) == VESALIUS_STANCE_UNKNOWN && int(Stance::standing) == VESALIUS_STANCE_STANDING &&
              int(Stance::sitting) == VESALIUS_STANCE_SITTING && int(Stance::lying) == VESALIUS_STANCE_LYING &&
              int(Stance::fallen) == VESALIUS_STANCE_FALLEN);

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

const TrackedPerson& person_of(const vesalius_people* people, std::int32_t index) {
  return at(need(people, "people").people, index, "person");
}

/// Gives the caller an array as far as the header promises.
template <class T, class List, class Convert>
void give(const List& list, const char* name, T* buffer, std::int32_t capacity, std::int32_t* count,
          const Convert& convert) {
  const auto length = static_cast<std::int32_t>(list.size());
  if (capacity < 0) throw UsageError("capacity is " + std::to_string(capacity) + ", expected 0 or more");
  if (buffer == nullptr && capacity > 0) throw UsageError(std::string(name) + " is NULL, but capacity is not 0");
  if (count != nullptr) *count = length;
  if (buffer == nullptr) {
    if (count == nullptr) throw UsageError(std::string(name) + " and count are NULL");
    return;
  }
  if (capacity < length) {
    throw CapacityError(std::string(name) + ": capacity is " + std::to_string(capacity) + ", expected " +
                        std::to_string(length) + " or more");
  }
  std::transform(list.begin(), list.end(), buffer, convert);
}

/// Gives a picture of the people's size; one that is empty is filled with `outside`.
void give_picture(const vesalius_people& people, const Image<std::uint8_t>& picture, std::uint8_t outside,
                  const char* name, std::uint8_t* buffer, std::int32_t capacity, std::int32_t* count) {
  const auto same = [](std::uint8_t value) { return value; };
  if (!picture.empty()) return give(picture, name, buffer, capacity, count, same);
  give(Image<std::uint8_t>(people.width, people.height, outside), name, buffer, capacity, count, same);
}

vesalius_joint to_joint(const Joint& joint) {
  const Eigen::Vector3f place = joint.state != State::none ? joint.position : Eigen::Vector3f::Constant(kUnknown);
  return {place.x(), place.y(), place.z(), joint.confidence, static_cast<std::int32_t>(joint.state)};
}

vesalius_part to_part(const SkeletonPart& part) {
  const Eigen::Vector3f place = part.state != State::none ? part.centre : Eigen::Vector3f::Constant(kUnknown);
  const Eigen::Vector3f& extent = part.extent_m;
  return {place.x(),       place.y(),
          place.z(),       {extent.x(), extent.y(), extent.z()},
          part.confidence, static_cast<std::int32_t>(part.state)};
}

template <class Point>
vesalius_unseen to_unseen(const Point& point) {
  return {static_cast<std::int32_t>(point.unseen), point.behind};
}

vesalius_bone to_bone(const FittedBone& bone) {
  vesalius_bone values{};
  std::copy_n(bone.head.data(), 3, values.head_m);
  std::copy_n(bone.tail.data(), 3, values.tail_m);
  std::copy_n(bone.global.coeffs().data(), 4, values.rotation_xyzw);
  values.length_m = bone.length_m;
  values.confidence = bone.confidence;
  values.state = static_cast<std::int32_t>(bone.state);
  return values;
}

vesalius_rotation to_rotation(const std::optional<Eigen::Quaternionf>& rotation) {
  if (!rotation) return {kUnknown, kUnknown, kUnknown, kUnknown};
  return {rotation->x(), rotation->y(), rotation->z(), rotation->w()};
}

}  // namespace
}  // namespace vesalius::c

using namespace vesalius;
using namespace vesalius::c;

int32_t vesalius_people_count(const vesalius_people* people) {
  return guarded_value(-1, [&] { return static_cast<int32_t>(need(people, "people").people.size()); });
}

vesalius_status vesalius_people_get(const vesalius_people* people, int32_t index, vesalius_person* person) {
  return guarded([&] {
    const TrackedPerson& found = person_of(people, index);
    const Box& box = found.person.box;
    vesalius_person values{};
    values.id = found.state == TrackState::seen ? 0 : found.id;
    values.state = static_cast<std::int32_t>(found.state);
    values.score = found.person.score;
    values.box_u = box.u;
    values.box_v = box.v;
    values.box_width = box.width;
    values.box_height = box.height;
    values.yaw_rad = found.person.yaw ? found.person.yaw->yaw_rad : kUnknown;
    std::copy_n(found.velocity.data(), 3, values.velocity_m_s);
    values.stance = static_cast<std::int32_t>(found.stance);
    values.stature_m = found.body ? found.body->stature_m : kUnknown;
    write_struct(values, person, "person");
  });
}

vesalius_status vesalius_people_joints(const vesalius_people* people, int32_t index, const char* joint_set,
                                       vesalius_joint* joints, int32_t capacity, int32_t* count) {
  return guarded([&] {
    const TrackedPerson& found = person_of(people, index);
    const std::size_t set = find_joint_set(people->shared->detector.body(), set_or_usual(joint_set));
    give(found.person.joints[set], "joints", joints, capacity, count, to_joint);
  });
}

vesalius_status vesalius_people_parts(const vesalius_people* people, int32_t index, vesalius_part* parts,
                                      int32_t capacity, int32_t* count) {
  return guarded(
      [&] { give(person_of(people, index).person.skeleton.parts, "parts", parts, capacity, count, to_part); });
}

vesalius_status vesalius_people_joints_unseen(const vesalius_people* people, int32_t index, const char* joint_set,
                                              vesalius_unseen* unseen, int32_t capacity, int32_t* count) {
  return guarded([&] {
    const TrackedPerson& found = person_of(people, index);
    const std::size_t set = find_joint_set(people->shared->detector.body(), set_or_usual(joint_set));
    give(found.person.joints[set], "unseen", unseen, capacity, count, to_unseen<Joint>);
  });
}

vesalius_status vesalius_people_parts_unseen(const vesalius_people* people, int32_t index, vesalius_unseen* unseen,
                                             int32_t capacity, int32_t* count) {
  return guarded([&] {
    const std::vector<SkeletonPart>& parts = person_of(people, index).person.skeleton.parts;
    give(parts, "unseen", unseen, capacity, count, to_unseen<SkeletonPart>);
  });
}

vesalius_status vesalius_people_bones(const vesalius_people* people, int32_t index, vesalius_bone* bones,
                                      int32_t capacity, int32_t* count) {
  return guarded([&] {
    static const std::vector<FittedBone> none;
    const std::optional<FittedBody>& body = person_of(people, index).body;
    give(body ? body->bones : none, "bones", bones, capacity, count, to_bone);
  });
}

vesalius_status vesalius_people_rotations(const vesalius_people* people, int32_t index, const char* joint_set,
                                          vesalius_rotation* rotations, int32_t capacity, int32_t* count) {
  return guarded([&] {
    const TrackedPerson& found = person_of(people, index);
    const BodyModel& body = people->shared->detector.body();
    const JointSet& set = body.joint_sets[find_joint_set(body, set_or_usual(joint_set))];
    give(rotations_of(found, set), "rotations", rotations, capacity, count, to_rotation);
  });
}

vesalius_status vesalius_people_mask(const vesalius_people* people, int32_t index, uint8_t* mask, int32_t capacity,
                                     int32_t* count) {
  return guarded([&] {
    const TrackedPerson& found = person_of(people, index);
    give_picture(*people, found.person.mask, 0, "mask", mask, capacity, count);
  });
}

vesalius_status vesalius_people_labels(const vesalius_people* people, int32_t index, uint8_t* labels, int32_t capacity,
                                       int32_t* count) {
  return guarded([&] {
    const TrackedPerson& found = person_of(people, index);
    give_picture(*people, found.person.labels, kBackground, "labels", labels, capacity, count);
  });
}

void vesalius_people_destroy(vesalius_people* people) { delete people; }
