#include "view/people_log.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include "stream/json_numbers.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/frame_source.h"

namespace vesalius {
namespace {

constexpr const char* kUsualSet = "k4abt32";

using Place = std::array<float, 3>;

/// Numbers as a line of JSON has them, so that files are the same as those of recorded lines.
float as_told(float value) { return static_cast<float>(rounded(value)); }
Place as_told(const Eigen::Vector3f& v) { return {as_told(v.x()), as_told(v.y()), as_told(v.z())}; }
Eigen::Vector3f vector_of(const Place& place) { return {place[0], place[1], place[2]}; }

struct LoggedJoint {
  Place at;
  float confidence;
  State state;
};

struct LoggedBone {
  Place head, tail;
  std::array<float, 4> xyzw;
};

struct LoggedOne {
  int id;
  float score;
  std::vector<LoggedJoint> joints;
  std::vector<LoggedBone> bones;  ///< empty without a fitted body
  std::vector<float> shape;       ///< of the fitted body
};

LoggedOne logged(const TrackedPerson& tracked, std::size_t set, std::size_t index, bool followed) {
  LoggedOne one{followed ? tracked.id : static_cast<int>(index), as_told(tracked.person.score), {}, {}, {}};
  for (const Joint& joint : tracked.person.joints.at(set)) {
    const bool known = joint.state != State::none;
    one.joints.push_back(
        {known ? as_told(joint.position) : Place{}, known ? as_told(joint.confidence) : 0.F, joint.state});
  }
  if (!tracked.body || tracked.body->bones.size() != builtin_flesh().bones.size()) return one;
  for (const FittedBone& bone : tracked.body->bones) {
    const Eigen::Quaternionf& q = bone.global;
    one.bones.push_back(
        {as_told(bone.head), as_told(bone.tail), {as_told(q.x()), as_told(q.y()), as_told(q.z()), as_told(q.w())}});
  }
  std::ranges::transform(tracked.body->shape, std::back_inserter(one.shape),
                         [](float value) { return as_told(value); });
  one.joints.shrink_to_fit();
  one.bones.shrink_to_fit();
  return one;
}

RecordedPerson recorded(const LoggedOne& one, bool bodies) {
  RecordedPerson person;
  person.id = one.id;
  person.person.score = one.score;
  std::vector<Joint>& joints = person.person.joints.emplace_back();
  if (!bodies) {
    for (const LoggedJoint& joint : one.joints) {
      joints.push_back({joint.state, vector_of(joint.at), joint.confidence});
    }
  } else if (!one.bones.empty()) {
    FittedBody& body = person.body.emplace();
    body.shape = one.shape;
    std::vector<FittedBone>& bones = body.bones;
    for (const LoggedBone& logged_bone : one.bones) {
      FittedBone& bone = bones.emplace_back();
      bone.head = vector_of(logged_bone.head);
      bone.tail = vector_of(logged_bone.tail);
      const auto& [x, y, z, w] = logged_bone.xyzw;
      bone.global = {w, x, y, z};
    }
  }
  return person;
}

/// Returns the index of the set that tables have usually.
std::size_t usual_set(const BodyModel& body) {
  const auto found = std::ranges::find(body.joint_sets, kUsualSet, &JointSet::name);
  return found == body.joint_sets.end() ? 0 : static_cast<std::size_t>(found - body.joint_sets.begin());
}

std::vector<std::string> names_of(const JointSet& set) {
  std::vector<std::string> names;
  for (const auto& joint : set.joints) names.push_back(joint.name);
  return names;
}

}  // namespace

struct PeopleLog::LoggedFrame {
  std::string name;
  double time_s = 0.0;
  std::optional<FloorView> floor;
  std::vector<LoggedOne> people;
  int options = 0;

  std::size_t bytes() const {
    constexpr std::size_t kNode = 128;  // of the map, the queue and the heap
    std::size_t sum = sizeof(LoggedFrame) + kNode + name.capacity() + people.capacity() * sizeof(LoggedOne);
    for (const LoggedOne& one : people) {
      sum += one.joints.capacity() * sizeof(LoggedJoint) + one.bones.capacity() * sizeof(LoggedBone) +
             one.shape.capacity() * sizeof(float);
    }
    return sum;
  }
};

PeopleLog::PeopleLog(const BodyModel& body, double rate, std::size_t most_bytes)
    : set_index_(usual_set(body)),
      set_(body.joint_sets.at(set_index_).name),
      joints_(names_of(body.joint_sets.at(set_index_))),
      rate_(rate),
      most_bytes_(most_bytes) {}

void PeopleLog::add(const ViewedFrame& viewed, int options) {
  {
    const std::scoped_lock lock(mutex_);
    const auto there = frames_.find(viewed.at_s);
    if (there != frames_.end() && there->second->options == options) return;
  }
  const TrackedFrame& found = viewed.people;
  const auto frame = std::make_shared<LoggedFrame>();
  frame->name = viewed.frame->name;
  const double time_s = viewed.frame->time_s.value_or(viewed.at_s * kUsualRate / rate_);
  frame->time_s = rounded(found.followed ? found.time_s : time_s, 1e6);
  if (found.floor) {
    frame->floor.emplace();
    frame->floor->up = vector_of(as_told(found.floor->up));
    frame->floor->height_m = as_told(found.floor->height_m);
  }
  frame->options = options;
  for (const TrackedPerson& person : found.people) {
    frame->people.push_back(logged(person, set_index_, frame->people.size(), found.followed));
  }
  const std::scoped_lock lock(mutex_);
  FramePointer& place = frames_[viewed.at_s];
  if (place) {
    bytes_ -= place->bytes();
  } else {
    order_.push_back(viewed.at_s);
  }
  bytes_ += frame->bytes();
  place = frame;
  while (bytes_ > most_bytes_ && order_.size() > 1) {
    const auto oldest = frames_.find(order_.front());
    bytes_ -= oldest->second->bytes();
    frames_.erase(oldest);
    order_.pop_front();
    ++forgotten_;
  }
}

std::vector<PeopleLog::FramePointer> PeopleLog::in_order() const {
  const std::scoped_lock lock(mutex_);
  std::vector<FramePointer> frames;
  for (const auto& [at_s, frame] : frames_) frames.push_back(frame);
  return frames;
}

std::vector<LoggedPerson> PeopleLog::people() const {
  std::map<int, LoggedPerson> people;
  for (const FramePointer& frame : in_order()) {
    for (const LoggedOne& one : frame->people) {
      LoggedPerson& person = people[one.id];
      person.id = one.id;
      ++person.frames;
      person.bodies += one.bones.empty() ? 0 : 1;
    }
  }
  std::vector<LoggedPerson> list;
  list.reserve(people.size());
  for (const auto& [id, person] : people) list.push_back(person);
  return list;
}

std::size_t PeopleLog::frames() const {
  const std::scoped_lock lock(mutex_);
  return frames_.size();
}

std::size_t PeopleLog::forgotten() const {
  const std::scoped_lock lock(mutex_);
  return forgotten_;
}

PeopleRecord PeopleLog::record(bool bodies) const {
  PeopleRecord record;
  record.sets = {set_};
  record.joints = {joints_};
  for (const FleshBone& bone : builtin_flesh().bones) record.bones.push_back(bone.name);
  for (const FramePointer& frame : in_order()) {
    RecordedFrame& to = record.frames.emplace_back();
    to.name = frame->name;
    to.time_s = frame->time_s;
    to.floor = frame->floor;
    for (const LoggedOne& one : frame->people) to.people.push_back(recorded(one, bodies));
  }
  return record;
}

}  // namespace vesalius
