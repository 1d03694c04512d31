#include "export/stand_upright.h"

#include <algorithm>

#include "vesalius/track/track_floor.h"

namespace vesalius {
namespace {

void put(RecordedPerson& person, const Eigen::Isometry3f& onto_floor) {
  for (std::vector<Joint>& joints : person.person.joints) {
    for (Joint& joint : joints) joint.position = onto_floor * joint.position;
  }
  if (!person.body) return;
  for (FittedBone& bone : person.body->bones) {
    bone.head = onto_floor * bone.head;
    bone.tail = onto_floor * bone.tail;
    bone.global = Eigen::Quaternionf(onto_floor.linear()) * bone.global;
  }
}

}  // namespace

bool stand_upright(PeopleRecord& record) {
  const auto known = std::ranges::find_if(record.frames, [](const RecordedFrame& f) { return f.floor.has_value(); });
  if (known == record.frames.end()) return false;
  Eigen::Isometry3f onto_floor = floor_from_optical(*known->floor);
  for (RecordedFrame& frame : record.frames) {
    if (frame.floor) onto_floor = floor_from_optical(*frame.floor);
    for (RecordedPerson& person : frame.people) put(person, onto_floor);
  }
  record.upright = true;
  return true;
}

}  // namespace vesalius
