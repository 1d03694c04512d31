#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>

#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius {

/// The people of a frame.
struct FoundPeople {
  Frame frame;  ///< without its pictures
  std::shared_ptr<const BodyModel> body;
  TrackedFrame people;
  std::weak_ptr<const Frame> seen;  ///< the frame with its pictures, as long as somebody has it

  std::size_t size() const { return people.people.size(); }
};

struct PythonPeople {
  std::shared_ptr<const FoundPeople> of;
};

/// Defines Person, Bone, Floor, Event and People.
void bind_people(nanobind::module_& m);

}  // namespace vesalius
