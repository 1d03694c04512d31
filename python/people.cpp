#include "people.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "arrays.h"
#include "stream/person_json.h"
#include "vesalius/base/find_joint_set.h"
#include "vesalius/fit/flesh_joints.h"
#include "vesalius/fit/flesh_model.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace vesalius {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
using Floats = nb::ndarray<nb::numpy, float>;

std::array<float, 3> array_of(const Eigen::Vector3f& point) { return {point.x(), point.y(), point.z()}; }

/// One of the people.
struct PythonPerson {
  std::shared_ptr<const FoundPeople> of;
  std::size_t index;

  const Person& person() const { return of->person(index); }
  const TrackedPerson* tracked() const { return of->tracked ? &of->tracked->people[index] : nullptr; }
  const FittedBody* fitted() const { return tracked() && tracked()->body ? &*tracked()->body : nullptr; }
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

void append(const Eigen::Vector3f& point, bool known, std::vector<float>& to) {
  for (int axis = 0; axis < 3; ++axis) to.push_back(known ? point[axis] : kUnknown);
}

void append_joints(const PythonPerson& p, const std::string& set, std::vector<float>& to) {
  for (const Joint& joint : p.joints(set)) append(joint.position, joint.state != State::none, to);
}

void append_parts(const PythonPerson& p, std::vector<float>& to) {
  for (const SkeletonPart& part : p.person().skeleton.parts) append(part.centre, part.state != State::none, to);
}

Floats confidences(const PythonPerson& p, const std::string& set) {
  std::vector<float> values;
  for (const Joint& joint : p.joints(set)) values.push_back(joint.confidence);
  const std::size_t count = values.size();
  return vesalius::array_of(std::move(values), {count});
}

Floats part_confidences(const PythonPerson& p) {
  std::vector<float> values;
  for (const SkeletonPart& part : p.person().skeleton.parts) values.push_back(part.confidence);
  const std::size_t count = values.size();
  return vesalius::array_of(std::move(values), {count});
}

Floats rotations(const PythonPerson& p, const std::string& name) {
  const JointSet& set = p.of->body->joint_sets[find_joint_set(*p.of->body, name)];
  std::vector<std::optional<Eigen::Quaternionf>> known(set.joints.size());
  if (p.fitted()) known = joint_rotations(*p.fitted(), builtin_flesh_joints(), set);
  std::vector<float> values;
  for (const auto& rotation : known) {
    for (int i = 0; i < 4; ++i) values.push_back(rotation ? rotation->coeffs()[i] : kUnknown);
  }
  return vesalius::array_of(std::move(values), {known.size(), 4});
}

std::vector<PythonBone> bones(const PythonPerson& p) {
  std::vector<PythonBone> all;
  if (!p.fitted()) return all;
  const std::vector<FleshBone>& names = builtin_flesh().bones;
  for (std::size_t b = 0; b < p.fitted()->bones.size(); ++b)
    all.push_back({p.of, &p.fitted()->bones[b], names[b].name});
  return all;
}

/// Pictures of all people; of those who are not found in the frame, and have none, `outside`.
template <class Picture>
nb::ndarray<nb::numpy, std::uint8_t> stacked(const PythonPeople& p, std::uint8_t outside, const Picture& picture) {
  const auto height = static_cast<std::size_t>(p.of->frame.camera.height);
  const auto width = static_cast<std::size_t>(p.of->frame.camera.width);
  std::vector<std::uint8_t> values(p.of->size() * height * width, outside);
  for (std::size_t i = 0; i < p.of->size(); ++i) {
    const Image<std::uint8_t>& image = picture(p.of->person(i));
    std::copy(image.begin(), image.end(), values.begin() + static_cast<std::ptrdiff_t>(i * height * width));
  }
  return vesalius::array_of(std::move(values), {p.of->size(), height, width});
}

/// As the program writes it, so that what reads its files reads this.
std::string json_of(const PythonPeople& p) {
  const FoundPeople& of = *p.of;
  return of.tracked ? tracked_frame_json(of.frame, *of.tracked, *of.body) : frame_json(of.frame, of.found, *of.body);
}

void bind_bone(nb::module_& m) {
  nb::class_<PythonBone>(m, "Bone", "A bone of the body that a Tracker fits to a person.")
      .def_ro("name", &PythonBone::name)
      .def_prop_ro(
          "head", [](const PythonBone& b) { return array_of(b.bone->head); },
          "(x, y, z) of the joint about which it turns: metres, optical frame.")
      .def_prop_ro(
          "tail", [](const PythonBone& b) { return array_of(b.bone->tail); }, "(x, y, z) of its other end.")
      .def_prop_ro(
          "rotation",
          [](const PythonBone& b) {
            const Eigen::Vector4f xyzw = b.bone->global.coeffs();
            return std::array<float, 4>{xyzw[0], xyzw[1], xyzw[2], xyzw[3]};
          },
          "Unit quaternion (x, y, z, w): optical frame from the bone's.")
      .def_prop_ro(
          "length", [](const PythonBone& b) { return b.bone->length_m; }, "Metres from head to tail.")
      .def_prop_ro(
          "confidence", [](const PythonBone& b) { return b.bone->confidence; },
          "Probability that the head lies within 10 cm of the truth, 0 to 1.")
      .def_prop_ro(
          "state", [](const PythonBone& b) { return std::string(to_string(b.bone->state)); },
          "observed where the camera sees flesh about its head, otherwise predicted.")
      .def("__repr__", [](const PythonBone& b) { return "<vesalius.Bone " + b.name + ">"; });
}

void bind_place(nb::class_<PythonPerson>& person) {
  person
      .def_prop_ro(
          "score", [](const PythonPerson& p) { return p.person().score; }, "How certain it is, 0 to 1.")
      .def_prop_ro(
          "box",
          [](const PythonPerson& p) {
            const Box& b = p.person().box;
            return std::vector<int>{b.u, b.v, b.width, b.height};
          },
          "Column, row, width and height of the smallest box around the mask, pixels.")
      .def_prop_ro(
          "yaw",
          [](const PythonPerson& p) {
            return p.person().yaw ? std::optional(p.person().yaw->yaw_rad) : std::optional<float>();
          },
          "Which way the person faces, radians: 0 the camera, positive turned to the person's own left; None if "
          "unknown.")
      .def_prop_ro(
          "mask", [](const PythonPerson& p) { return vesalius::array_of(p.person().mask); }, nb::rv_policy::automatic,
          "uint8 (height, width): 1 on the person's pixels; empty where the person is not found.")
      .def_prop_ro(
          "labels", [](const PythonPerson& p) { return vesalius::array_of(p.person().labels); },
          nb::rv_policy::automatic,
          "uint8 (height, width): part of each of the person's pixels, 255 elsewhere (Detector.parts).")
      .def_prop_ro(
          "parts",
          [](const PythonPerson& p) {
            std::vector<float> values;
            append_parts(p, values);
            return vesalius::array_of(std::move(values), {p.person().skeleton.parts.size(), 3});
          },
          nb::rv_policy::automatic,
          "float32 (parts, 3): centre of each part's visible surface, metres, optical frame; NaN where unknown.")
      .def_prop_ro("part_confidences", &part_confidences, nb::rv_policy::automatic, "float32 (parts,): 0 to 1.")
      .def_prop_ro(
          "part_states",
          [](const PythonPerson& p) {
            std::vector<std::string> states;
            for (const SkeletonPart& part : p.person().skeleton.parts) states.emplace_back(to_string(part.state));
            return states;
          },
          "For each part: observed, predicted or none.")
      .def(
          "joints",
          [](const PythonPerson& p, const std::string& set) {
            std::vector<float> values;
            append_joints(p, set, values);
            return vesalius::array_of(std::move(values), {p.joints(set).size(), 3});
          },
          "set"_a = "k4abt32",
          "float32 (joints, 3): metres, optical frame (x right, y down, z away); NaN where unknown.")
      .def("confidences", &confidences, "set"_a = "k4abt32", "float32 (joints,): 0 to 1.")
      .def(
          "states",
          [](const PythonPerson& p, const std::string& set) {
            std::vector<std::string> states;
            for (const Joint& joint : p.joints(set)) states.emplace_back(to_string(joint.state));
            return states;
          },
          "set"_a = "k4abt32", "For each joint: observed, predicted or none.");
}

void bind_time(nb::class_<PythonPerson>& person) {
  person
      .def_prop_ro(
          "id",
          [](const PythonPerson& p) { return p.tracked() ? std::optional(p.tracked()->id) : std::optional<int>(); },
          "The id that a Tracker gives and keeps; None from a Detector.")
      .def_prop_ro(
          "state",
          [](const PythonPerson& p) { return std::string(p.tracked() ? to_string(p.tracked()->state) : "seen"); },
          "new, tracked, hidden or lost; seen from a Detector.")
      .def_prop_ro(
          "velocity",
          [](const PythonPerson& p) {
            return p.tracked() ? std::optional(array_of(p.tracked()->velocity)) : std::optional<std::array<float, 3>>();
          },
          "Of the trunk, metres a second, optical frame; None from a Detector.")
      .def_prop_ro(
          "stance",
          [](const PythonPerson& p) {
            return std::string(to_string(p.tracked() ? p.tracked()->stance : Stance::unknown));
          },
          "standing, sitting, lying or fallen; unknown where no floor is seen, and from a Detector.")
      .def_prop_ro(
          "stature",
          [](const PythonPerson& p) {
            return p.fitted() ? std::optional(p.fitted()->stature_m) : std::optional<float>();
          },
          "Height of the person standing upright, metres, by the fitted body; None without one.")
      .def_prop_ro("bones", &bones, "The bones of the fitted body, parents first; empty without one.")
      .def("rotations", &rotations, "set"_a = "k4abt32",
           "float32 (joints, 4): unit quaternions (x, y, z, w) in the convention of the tracker that names the joints, "
           "by the fitted body; NaN where unknown. k4abt32 has them.");
}

void bind_person(nb::module_& m) {
  nb::class_<PythonPerson> person(m, "Person", "Somebody who was found in a frame.");
  bind_place(person);
  bind_time(person);
  person.def("__repr__", [](const PythonPerson& p) {
    const TrackedPerson* tracked = p.tracked();
    return "<vesalius.Person" + (tracked ? " " + std::to_string(tracked->id) : std::string()) + " " +
           (tracked ? to_string(tracked->state) : "seen") + ", score " + std::to_string(p.person().score) + ">";
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
            const std::size_t joints = p.of->body->joint_sets[find_joint_set(*p.of->body, set)].joints.size();
            std::vector<float> values;
            for (std::size_t i = 0; i < p.of->size(); ++i) append_joints({p.of, i}, set, values);
            return vesalius::array_of(std::move(values), {p.of->size(), joints, 3});
          },
          "set"_a = "k4abt32", "float32 (people, joints, 3): metres, optical frame; NaN where unknown.")
      .def_prop_ro(
          "parts",
          [](const PythonPeople& p) {
            std::vector<float> values;
            for (std::size_t i = 0; i < p.of->size(); ++i) append_parts({p.of, i}, values);
            return vesalius::array_of(std::move(values), {p.of->size(), p.of->body->parts.size(), 3});
          },
          nb::rv_policy::automatic, "float32 (people, parts, 3): centres of parts, metres; NaN where unknown.")
      .def_prop_ro(
          "masks",
          [](const PythonPeople& p) {
            return stacked(p, 0, [](const Person& one) -> const Mask& { return one.mask; });
          },
          nb::rv_policy::automatic, "uint8 (people, height, width): 1 on each person's pixels.")
      .def_prop_ro(
          "labels",
          [](const PythonPeople& p) {
            return stacked(p, kBackground, [](const Person& one) -> const LabelImage& { return one.labels; });
          },
          nb::rv_policy::automatic, "uint8 (people, height, width): part of each person's pixels, 255 elsewhere.")
      .def_prop_ro(
          "ids",
          [](const PythonPeople& p) {
            std::vector<std::optional<int>> ids(p.of->size());
            for (std::size_t i = 0; p.of->tracked && i < ids.size(); ++i) ids[i] = p.of->tracked->people[i].id;
            return ids;
          },
          "The people's ids, None from a Detector.")
      .def("json", &json_of, "The line that the program writes about the frame with --json (docs/formats.md).")
      .def_prop_ro(
          "part_names",
          [](const PythonPeople& p) {
            std::vector<std::string> names;
            for (const BodyPart& part : p.of->body->parts) names.push_back(part.name);
            return names;
          },
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
