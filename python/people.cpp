#include "people.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <type_traits>
#include <utility>

#include "arrays.h"
#include "stream/person_fields.h"
#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/person_json.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace vesalius {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
using Floats = nb::ndarray<nb::numpy, float>;

/// One of the people.
struct PythonPerson {
  std::shared_ptr<const FoundPeople> of;
  std::size_t index;

  const TrackedPerson& tracked() const { return of->people.people[index]; }
  bool is_followed() const { return of->people.followed; }
  const Person& person() const { return tracked().person; }
  bool has_body() const { return tracked().body.has_value(); }
  const FittedBody& body() const { return *tracked().body; }
  const std::vector<SkeletonPart>& parts() const { return person().skeleton.parts; }
  const std::vector<Joint>& joints(const std::string& set) const {
    return person().joints[find_joint_set(*of->body, set)];
  }
};

/// A bone of a body fitted to a person.
struct PythonBone {
  std::shared_ptr<const FoundPeople> of;  ///< keeps `bone`
  const FittedBone* bone;
  std::string name;
};

/// Returns a field's value as Python has it.
template <class Value>
auto python_value(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return std::string(to_string(value));
  } else if constexpr (std::is_same_v<Value, Eigen::Vector3f>) {
    return std::array<float, 3>{value.x(), value.y(), value.z()};
  } else if constexpr (std::is_same_v<Value, Eigen::Quaternionf>) {
    return std::array<float, 4>{value.x(), value.y(), value.z(), value.w()};
  } else if constexpr (std::is_same_v<Value, Eigen::Matrix3f>) {
    return std::array<float, 6>{value(0, 0), value(0, 1), value(0, 2), value(1, 1), value(1, 2), value(2, 2)};
  } else if constexpr (std::is_same_v<Value, Box>) {
    return std::vector<int>{value.u, value.v, value.width, value.height};
  } else if constexpr (std::is_same_v<Value, std::optional<YawEstimate>>) {
    return value ? std::optional(value->yaw_rad) : std::nullopt;
  } else {
    return value;
  }
}

/// Gives a class the fields of a struct, which `find` finds in an object: words always, others None unless `known`.
template <class Struct, class Class, class Find, class Known = std::nullptr_t>
void bind_fields(nb::class_<Class>& to, const Find& find, const Known& known = nullptr) {
  visit_fields<Struct>([&](const auto& field) {
    const auto value = [find, member = field.member](const Class& object) {
      return python_value(find(object).*member);
    };
    using Value = decltype(value(std::declval<const Class&>()));
    const char* name = std::string_view(field.name) == "global" ? "rotation" : field.name;  // Python's keyword
    if constexpr (std::is_same_v<Known, std::nullptr_t> || std::is_same_v<Value, std::string>) {
      to.def_prop_ro(name, value, field.help);
    } else {
      to.def_prop_ro(
          name,
          [value, known](const Class& object) {
            return known(object) ? std::optional<Value>(value(object)) : std::nullopt;
          },
          field.help);
    }
  });
}

// Joints and parts alike, a row each.

const Eigen::Vector3f& place_of(const Joint& joint) { return joint.position; }
const Eigen::Vector3f& place_of(const SkeletonPart& part) { return part.centre; }

template <class Point>
void append_places(const std::vector<Point>& points, std::vector<float>& to) {
  for (const Point& point : points) {
    for (const float x : place_of(point)) to.push_back(point.state != State::none ? x : kUnknown);
  }
}

template <class Point>
Floats places(const std::vector<Point>& points) {
  std::vector<float> values;
  append_places(points, values);
  return array_of(std::move(values), {points.size(), 3});
}

template <class Point>
Floats confidences(const std::vector<Point>& points) {
  std::vector<float> values;
  for (const Point& point : points) values.push_back(point.confidence);
  return array_of(std::move(values), {points.size()});
}

template <class Point>
std::vector<std::string> states(const std::vector<Point>& points) {
  std::vector<std::string> words;
  for (const Point& point : points) words.emplace_back(to_string(point.state));
  return words;
}

template <class Point>
std::vector<std::optional<std::string>> reasons(const std::vector<Point>& points) {
  std::vector<std::optional<std::string>> words;
  for (const Point& point : points) {
    const bool seen = point.unseen == Unseen::none;
    words.push_back(seen ? std::nullopt : std::optional<std::string>(to_string(point.unseen)));
  }
  return words;
}

template <class Point>
std::vector<std::optional<int>> hiders(const std::vector<Point>& points) {
  std::vector<std::optional<int>> people;
  for (const Point& point : points) {
    people.push_back(point.behind < 0 ? std::nullopt : std::optional(point.behind));
  }
  return people;
}

/// Returns the places of so many points of everybody.
template <class PointsOf>
Floats places_of_all(const PythonPeople& p, std::size_t count, const PointsOf& points_of) {
  std::vector<float> values;
  for (std::size_t i = 0; i < p.of->size(); ++i) append_places(points_of(PythonPerson{p.of, i}), values);
  return array_of(std::move(values), {p.of->size(), count, 3});
}

Floats rotations(const PythonPerson& p, const std::string& name) {
  const auto known = rotations_of(p.tracked(), p.of->body->joint_sets[find_joint_set(*p.of->body, name)]);
  std::vector<float> values;
  for (const auto& rotation : known) {
    for (int i = 0; i < 4; ++i) values.push_back(rotation ? rotation->coeffs()[i] : kUnknown);
  }
  return array_of(std::move(values), {known.size(), 4});
}

std::vector<PythonBone> bones(const PythonPerson& p) {
  std::vector<PythonBone> all;
  if (!p.has_body()) return all;
  for (const FittedBone& bone : p.body().bones) all.push_back({p.of, &bone, builtin_flesh().bones[all.size()].name});
  return all;
}

/// Pictures of all people; of those who are not found in the frame, and have none, `outside`.
nb::ndarray<nb::numpy, std::uint8_t> stacked(const PythonPeople& p, std::uint8_t outside,
                                             const Image<std::uint8_t> Person::*picture) {
  const auto height = static_cast<std::size_t>(p.of->frame.camera.height);
  const auto width = static_cast<std::size_t>(p.of->frame.camera.width);
  std::vector<std::uint8_t> values(p.of->size() * height * width, outside);
  for (std::size_t i = 0; i < p.of->size(); ++i) {
    const Image<std::uint8_t>& image = p.of->people.people[i].person.*picture;
    std::copy(image.begin(), image.end(), values.begin() + static_cast<std::ptrdiff_t>(i * height * width));
  }
  return array_of(std::move(values), {p.of->size(), height, width});
}

void bind_bone(nb::module_& m) {
  nb::class_<PythonBone> bone(m, "Bone", "A bone of the body that a Tracker fits to a person.");
  bone.def_ro("name", &PythonBone::name);
  bind_fields<FittedBone>(bone, [](const PythonBone& b) -> const FittedBone& { return *b.bone; });
  bone.def("__repr__", [](const PythonBone& b) { return "<vesalius.Bone " + b.name + ">"; });
}

void bind_points(nb::class_<PythonPerson>& person) {
  using One = const PythonPerson&;
  using Set = const std::string&;
  constexpr auto copied = nb::rv_policy::automatic;
  person.def_prop_ro(
      "mask", [](One p) { return array_of(p.person().mask); }, copied,
      "uint8 (height, width): 1 on the person's pixels; empty where the person is not found.");
  person.def_prop_ro(
      "labels", [](One p) { return array_of(p.person().labels); }, copied,
      "uint8 (height, width): part of each of the person's pixels, 255 elsewhere (Detector.parts).");
  person.def_prop_ro(
      "parts", [](One p) { return places(p.parts()); }, copied,
      "float32 (parts, 3): centre of each part's visible surface, metres, optical frame; NaN where unknown.");
  person.def_prop_ro(
      "part_confidences", [](One p) { return confidences(p.parts()); }, copied, "float32 (parts,): 0 to 1.");
  person.def_prop_ro(
      "part_states", [](One p) { return states(p.parts()); }, "For each part: observed, predicted or none.");
  person.def_prop_ro(
      "part_unseen", [](One p) { return reasons(p.parts()); },
      "For each part why it is not observed: out_of_picture, behind_person, behind_something, no_depth, not_sure; "
      "None of those observed.");
  person.def_prop_ro(
      "part_behind", [](One p) { return hiders(p.parts()); },
      "For each part that is behind_person the index in People of who hides it, the person's own behind the own body; "
      "None of others.");
  person.def(
      "joints", [](One p, Set set) { return places(p.joints(set)); }, "set"_a = "k4abt32",
      "float32 (joints, 3): metres, optical frame (x right, y down, z away); NaN where unknown.");
  person.def(
      "confidences", [](One p, Set set) { return confidences(p.joints(set)); }, "set"_a = "k4abt32",
      "float32 (joints,): 0 to 1.");
  person.def(
      "states", [](One p, Set set) { return states(p.joints(set)); }, "set"_a = "k4abt32",
      "For each joint: observed, predicted or none.");
  person.def(
      "unseen", [](One p, Set set) { return reasons(p.joints(set)); }, "set"_a = "k4abt32",
      "For each joint why it is not observed, as part_unseen.");
  person.def(
      "behind", [](One p, Set set) { return hiders(p.joints(set)); }, "set"_a = "k4abt32",
      "For each joint who hides it, as part_behind.");
  person.def_prop_ro("bones", &bones, "The bones of the fitted body, parents first; empty without one.");
  person.def(
      "rotations", &rotations, "set"_a = "k4abt32",
      "float32 (joints, 4): unit quaternions (x, y, z, w) in the convention of the tracker that names the joints, "
      "by the fitted body; NaN where unknown. k4abt32 has them.");
}

void bind_person(nb::module_& m) {
  nb::class_<PythonPerson> person(m, "Person", "Somebody who was found in a frame.");
  bind_fields<TrackedPerson>(person, std::mem_fn(&PythonPerson::tracked), std::mem_fn(&PythonPerson::is_followed));
  bind_fields<Person>(person, std::mem_fn(&PythonPerson::person));
  bind_fields<FittedBody>(person, std::mem_fn(&PythonPerson::body), std::mem_fn(&PythonPerson::has_body));
  bind_points(person);
  person.def("__repr__", [](const PythonPerson& p) {
    const TrackedPerson& tracked = p.tracked();
    return "<vesalius.Person" + (p.is_followed() ? " " + std::to_string(tracked.id) : "") + " " +
           to_string(tracked.state) + ", score " + std::to_string(p.person().score) + ">";
  });
}

}  // namespace

void bind_people(nb::module_& m) {
  bind_bone(m);
  bind_person(m);
  nb::class_<PythonPeople>(m, "People", "The people of a frame: a sequence, and arrays over all of them.")
      .def("__len__", [](const PythonPeople& p) { return p.of->size(); })
      .def("__getitem__",
           [](const PythonPeople& p, std::ptrdiff_t i) {
             const auto count = static_cast<std::ptrdiff_t>(p.of->size());
             if (i < 0) i += count;
             if (i < 0 || i >= count) throw nb::index_error();
             return PythonPerson{p.of, static_cast<std::size_t>(i)};
           })
      .def(
          "joints",
          [](const PythonPeople& p, const std::string& set) {
            const std::size_t count = p.of->body->joint_sets[find_joint_set(*p.of->body, set)].joints.size();
            return places_of_all(p, count, [&](const PythonPerson& one) { return one.joints(set); });
          },
          "set"_a = "k4abt32", "float32 (people, joints, 3): metres, optical frame; NaN where unknown.")
      .def_prop_ro(
          "parts",
          [](const PythonPeople& p) {
            return places_of_all(p, p.of->body->parts.size(), [](const PythonPerson& one) { return one.parts(); });
          },
          nb::rv_policy::automatic, "float32 (people, parts, 3): centres of parts, metres; NaN where unknown.")
      .def_prop_ro(
          "masks", [](const PythonPeople& p) { return stacked(p, 0, &Person::mask); }, nb::rv_policy::automatic,
          "uint8 (people, height, width): 1 on each person's pixels.")
      .def_prop_ro(
          "labels", [](const PythonPeople& p) { return stacked(p, kBackground, &Person::labels); },
          nb::rv_policy::automatic, "uint8 (people, height, width): part of each person's pixels, 255 elsewhere.")
      .def_prop_ro(
          "ids",
          [](const PythonPeople& p) {
            std::vector<std::optional<int>> ids;
            for (const TrackedPerson& person : p.of->people.people) {
              ids.push_back(p.of->people.followed ? std::optional(person.id) : std::nullopt);
            }
            return ids;
          },
          "The people's ids, None from a Detector.")
      .def(
          "json", [](const PythonPeople& p) { return frame_json(p.of->frame, p.of->people, *p.of->body); },
          "The line that the program writes about the frame with --json (docs/formats.md).")
      .def_prop_ro(
          "part_names", [](const PythonPeople& p) { return names_of(p.of->body->parts); },
          "Names of the parts, by their numbers in labels.")
      .def_prop_ro(
          "part_colours",
          [](const PythonPeople& p) {
            std::vector<std::array<int, 3>> colours;
            for (const BodyPart& part : p.of->body->parts) {
              colours.push_back({part.colour.r, part.colour.g, part.colour.b});
            }
            return colours;
          },
          "Red, green and blue of each part in pictures, 0 to 255.")
      .def_prop_ro(
          "links",
          [](const PythonPeople& p) {
            std::vector<std::pair<int, int>> links;
            for (const BodyLink& link : p.of->body->links) links.emplace_back(link.parent, link.child);
            return links;
          },
          "Pairs of parts that touch, by their numbers: the lines of a skeleton.");
}

}  // namespace vesalius
