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
#include "pictures.h"
#include "stream/person_fields.h"
#include "vesalius/body_model.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/image_file.h"
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
  const std::vector<Joint>& smoothed(const std::string& set) const {
    if (!is_followed()) throw UsageError("smoothed: a Detector sees one frame alone; the people of a Tracker have it");
    const std::vector<std::vector<Joint>>& sets = tracked().smoothed.empty() ? person().joints : tracked().smoothed;
    return sets[find_joint_set(*of->body, set)];
  }
};

/// Something that happened, with the words for it.
struct PythonEvent {
  StanceEvent event;

  const char* what() const {
    const bool known = event.before != Stance::unknown;
    switch (event.stance) {
      case Stance::standing:
        return known ? "stood up" : "stands";
      case Stance::sitting:
        return !known ? "sits" : event.before == Stance::standing ? "sat down" : "sat up";
      case Stance::lying:
        return known ? "lay down" : "lies";
      case Stance::fallen:
        return "fell";
      default:
        return "is no longer known";
    }
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

/// Returns what a function of vesalius/_show.py makes of an object.
template <class... More>
std::string shown(const char* function, nb::handle object, const More&... more) {
  return nb::cast<std::string>(nb::module_::import_("vesalius._show").attr(function)(object, more...));
}

/// Returns a JPEG of people over the frame in which they were found, or over black where nobody has it any more.
nb::bytes picture_of(const PythonPeople& p) {
  constexpr int kQuality = 85;
  const std::shared_ptr<const Frame> seen = p.of->seen.lock();
  Frame black = p.of->frame;
  black.depth = DepthImage(black.camera.width, black.camera.height);
  const std::string jpeg = encode_jpeg(drawn(*p.of, seen ? *seen : black), kQuality);
  return nb::bytes(jpeg.data(), jpeg.size());
}

nb::ndarray<nb::numpy, std::uint8_t> as_array(const ColourImage& image) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(image.data());
  return array_of(std::vector<std::uint8_t>(bytes, bytes + 3 * image.size()),
                  {static_cast<std::size_t>(image.height()), static_cast<std::size_t>(image.width()), 3});
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
  person.def(
      "smoothed", [](One p, Set set) { return places(p.smoothed(set)); }, "set"_a = "k4abt32",
      "float32 (joints, 3): as joints, smoothed over time, of whom a Tracker follows. Raises ValueError for others.");
  person.def(
      "pixels",
      [](One p, Set set) { return project(p.of->frame.camera, nb::cast<Places>(nb::cast(places(p.joints(set))))); },
      "set"_a = "k4abt32",
      "float64 (joints, 2): columns and rows of the joints in the picture, also outside of it; NaN where unknown or "
      "not "
      "in front of the camera.");
  person.def(
      "points",
      [](One p, const PythonFrame& frame) {
        return points_of(p.of->frame.camera, frame.frame->depth, p.person().mask);
      },
      "frame"_a,
      "float32 (points, 3): what the camera sees of the person, metres, optical frame: the pixels of the mask with "
      "readings, row by row. frame: the one in which the person was found.");
  person.def(
      "points",
      [](One p, const AnyArray& depth) {
        return points_of(p.of->frame.camera, depth_image_of(depth), p.person().mask);
      },
      "depth"_a, "The same of a depth picture that is an array.");
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
  person.def("__repr__", [](nb::handle self) { return shown("person_text", self); });
}

void bind_floor(nb::module_& m) {
  nb::class_<FloorView>(m, "Floor", "The floor and how the camera stands over it.")
      .def_prop_ro(
          "up", [](const FloorView& f) { return array_of(std::vector<float>(f.up.begin(), f.up.end()), {3}); },
          nb::rv_policy::automatic,
          "float32 (3,): unit vector away from the ground, optical frame. Points are joints @ up + height over it.")
      .def_ro("height", &FloorView::height_m, "Metres from the floor to the camera.")
      .def_ro("tilt", &FloorView::tilt_rad, "Radians by which the camera looks below the horizon; negative looks up.")
      .def_ro("roll", &FloorView::roll_rad, "Radians by which it is turned, clockwise as seen from it.")
      .def("__repr__", [](nb::handle self) { return shown("floor_text", self); });
}

void bind_event(nb::module_& m) {
  nb::class_<PythonEvent>(m, "Event", "Somebody holds the body in another way than before.")
      .def_prop_ro(
          "id", [](const PythonEvent& e) { return e.event.id; }, "Whose.")
      .def_prop_ro(
          "time", [](const PythonEvent& e) { return e.event.time_s; },
          "Seconds, when it began: earlier than the frame that tells it.")
      .def_prop_ro(
          "stance", [](const PythonEvent& e) { return std::string(to_string(e.event.stance)); },
          "standing, sitting, lying, fallen, or unknown.")
      .def_prop_ro(
          "before", [](const PythonEvent& e) { return std::string(to_string(e.event.before)); },
          "The stance until then.")
      .def_prop_ro("what", &PythonEvent::what,
                   "stood up, sat down, sat up, lay down or fell; stands, sits or lies where nothing was known before.")
      .def("__repr__", [](nb::handle self) { return shown("event_text", self); });
}

}  // namespace

void bind_frame_facts(nb::class_<PythonPeople>& people) {
  using All = const PythonPeople&;
  people
      .def_prop_ro(
          "frame", [](All p) { return p.of->frame.name; }, "Name of the frame in which they were found.")
      .def_prop_ro(
          "time", [](All p) { return p.of->people.followed ? p.of->people.time_s : p.of->frame.time_s; },
          "Its time, seconds, as a Tracker counts; None from a Detector where the frame has none.")
      .def_prop_ro(
          "camera", [](All p) { return PythonCamera(p.of->frame.camera); }, "Its camera.")
      .def_prop_ro(
          "floor", [](All p) { return p.of->people.floor; },
          "The floor; None where it is not seen, or from a Detector.")
      .def_prop_ro(
          "events",
          [](All p) {
            std::vector<PythonEvent> events;
            for (const StanceEvent& event : p.of->people.events) events.push_back({event});
            return events;
          },
          "What this frame tells of people who stood up, sat down, lay down or fell, by their ids; none from a "
          "Detector.");
}

void bind_drawing(nb::class_<PythonPeople>& people) {
  using All = const PythonPeople&;
  people
      .def(
          "draw", [](All p, const PythonFrame& frame) { return as_array(drawn(*p.of, *frame.frame)); }, "frame"_a,
          "uint8 (height, width, 3): a copy of the frame's colour, or of its depth in colours, with masks, skeletons, "
          "numbers and scores drawn on it. Twice as wide and high where it is narrower than 480 pixels.")
      .def(
          "draw", [](All p, const AnyArray& picture) { return as_array(drawn(*p.of, picture)); }, "picture"_a,
          "The same on an array: colour (height, width, 3) uint8, or depth. Raises ValueError where it is not of the "
          "frame's size.")
      .def("__repr__", [](nb::handle self) { return shown("people_text", self); })
      .def("_repr_html_",
           [](nb::handle self) { return shown("people_html", self, picture_of(nb::cast<const PythonPeople&>(self))); });
}

void bind_people(nb::module_& m) {
  bind_bone(m);
  bind_person(m);
  bind_floor(m);
  bind_event(m);
  nb::class_<PythonPeople> people(m, "People", "The people of a frame: a sequence, and arrays over all of them.");
  bind_frame_facts(people);
  bind_drawing(people);
  people.def("__len__", [](const PythonPeople& p) { return p.of->size(); })
      .def(
          "__iter__",
          [](const PythonPeople& p) {
            nb::list all;
            for (std::size_t i = 0; i < p.of->size(); ++i) all.append(PythonPerson{p.of, i});
            return nb::iter(all);
          },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[Person]"))
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
      .def(
          "smoothed",
          [](const PythonPeople& p, const std::string& set) {
            const std::size_t count = p.of->body->joint_sets[find_joint_set(*p.of->body, set)].joints.size();
            return places_of_all(p, count, [&](const PythonPerson& one) { return one.smoothed(set); });
          },
          "set"_a = "k4abt32",
          "float32 (people, joints, 3): joints smoothed over time, from a Tracker; ValueError from a Detector.")
      .def(
          "pixels",
          [](const PythonPeople& p, const std::string& set) {
            const std::size_t count = p.of->body->joint_sets[find_joint_set(*p.of->body, set)].joints.size();
            const Floats joints = places_of_all(p, count, [&](const PythonPerson& one) { return one.joints(set); });
            return project(p.of->frame.camera, nb::cast<Places>(nb::cast(joints)));
          },
          "set"_a = "k4abt32",
          "float64 (people, joints, 2): columns and rows in the picture; NaN where unknown or not in front of the "
          "camera.")
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
