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

  std::size_t size() const { return people.people.size(); }
};

struct PythonPeople {
  std::shared_ptr<const FoundPeople> of;
};

/// Defines Person, Bone and People.
void bind_people(nanobind::module_& m);

}  // namespace vesalius
