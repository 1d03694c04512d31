#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "c/read_frame.h"
#include "io/files/options_file.h"
#include "vesalius/track_people.h"
#include "vesalius/vesalius.h"

namespace vesalius::c {

/// What a detector's trackers and people share with it, so that they may outlive its handle.
struct SharedDetector {
  PeopleOptions options;
  int threads = 0;
  Detector detector;
  Rectifications rectifications = {};
};

/// The joint set of those who name none, as in Python.
inline const char* set_or_usual(const char* joint_set) { return joint_set != nullptr ? joint_set : "k4abt32"; }

}  // namespace vesalius::c

struct vesalius_options {
  vesalius::PeopleOptions values;
  std::vector<vesalius::OptionText> texts;  ///< texts of the values
};
struct vesalius_detector {
  std::shared_ptr<const vesalius::c::SharedDetector> shared;
};
struct vesalius_tracker {
  std::shared_ptr<const vesalius::c::SharedDetector> shared;
  vesalius::PeopleTracker tracker;
  std::mutex mutex = {};
};
struct vesalius_people {
  std::shared_ptr<const vesalius::c::SharedDetector> shared;
  int width = 0, height = 0;
  std::vector<vesalius::TrackedPerson> people = {};
};
