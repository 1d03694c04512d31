#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/detection.h"
#include "vesalius/track/tracked_frame.h"

namespace vesalius {

/// The people of a frame: as found, or as followed.
struct FoundPeople {
  Frame frame;  ///< without its pictures
  std::shared_ptr<const BodyModel> body;
  std::vector<Person> found;
  std::optional<TrackedFrame> tracked;  ///< then `found` is empty

  std::size_t size() const { return tracked ? tracked->people.size() : found.size(); }
  const Person& person(std::size_t i) const { return tracked ? tracked->people[i].person : found[i]; }
};

struct PythonPeople {
  std::shared_ptr<const FoundPeople> of;
};

/// Defines Person, Bone and People.
void bind_people(nanobind::module_& m);

}  // namespace vesalius
