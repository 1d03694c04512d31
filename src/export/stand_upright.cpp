#include "export/stand_upright.h"

#include <algorithm>

#include "vesalius/merge/carry_people.h"
#include "vesalius/track/track_floor.h"

namespace vesalius {
bool stand_upright(PeopleRecord& record) {
  const auto known = std::ranges::find_if(record.frames, [](const RecordedFrame& f) { return f.floor.has_value(); });
  if (known == record.frames.end()) return false;
  Eigen::Isometry3f onto_floor = floor_from_optical(*known->floor);
  for (RecordedFrame& frame : record.frames) {
    if (frame.floor) onto_floor = floor_from_optical(*frame.floor);
    for (RecordedPerson& person : frame.people) {
      carry(person.person.joints, onto_floor);
      if (person.body) carry(*person.body, onto_floor);
    }
  }
  record.upright = true;
  return true;
}

}  // namespace vesalius
