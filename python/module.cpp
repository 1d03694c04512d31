// The Python module vesalius._vesalius. Everything that takes long runs without the interpreter's lock.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/model/model_file.h"
#include "options_from_keywords.h"
#include "vesalius/base/error.h"
#include "vesalius/base/parallel.h"
#include "vesalius/detect.h"
#include "vesalius/track/people_options.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace vesalius {
namespace {

/// The camera of the depth picture, in pixels.
struct PythonCamera {
  float fx, fy, cx, cy;
};

using AnyArray = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;

std::string shape_of(const AnyArray& array) {
  std::string text;
  for (std::size_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? "x" : "") + std::to_string(array.shape(i));
  return text;
}

DepthImage depth_of(const AnyArray& array) {
  if (array.ndim() != 2) throw UsageError("depth: an array of shape " + shape_of(array) + ", expected height x width");
  constexpr std::size_t kMostSide = 16000;
  if (array.shape(0) > kMostSide || array.shape(1) > kMostSide) {
    throw UsageError("depth: an array of shape " + shape_of(array) + ", expected at most 16000 a side");
  }
  DepthImage depth(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)));
  if (array.dtype() == nb::dtype<std::uint16_t>()) {
    std::memcpy(depth.data(), array.data(), depth.size() * sizeof(std::uint16_t));
  } else if (array.dtype() == nb::dtype<float>()) {
    const auto* metres = static_cast<const float*>(array.data());
    for (std::size_t i = 0; i < depth.size(); ++i) {
      // What is no number, or no distance, is no reading (as ROS has it).
      const float mm = metres[i] * 1000.F;
      depth[i] = mm >= 0.5F && mm < 65535.F ? static_cast<std::uint16_t>(mm + 0.5F) : std::uint16_t{0};
    }
  } else {
    throw UsageError("depth: expected dtype uint16 (millimetres) or float32 (metres)");
  }
  return depth;
}

ColourImage colour_of(const std::optional<AnyArray>& array, const DepthImage& depth) {
  if (!array) return {};
  const bool fits = array->ndim() == 3 && static_cast<int>(array->shape(0)) == depth.height() &&
                    static_cast<int>(array->shape(1)) == depth.width() && array->shape(2) == 3;
  if (!fits || array->dtype() != nb::dtype<std::uint8_t>()) {
    throw UsageError("colour: an array of shape " + shape_of(*array) + ", expected " + std::to_string(depth.height()) +
                     "x" + std::to_string(depth.width()) + "x3 of dtype uint8 (red, green, blue)");
  }
  ColourImage colour(depth.width(), depth.height());
  static_assert(sizeof(Rgb) == 3);
  std::memcpy(colour.data(), array->data(), colour.size() * sizeof(Rgb));
  return colour;
}

Frame frame_of(const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour,
               std::optional<double> time_s) {
  Frame frame;
  frame.depth = depth_of(depth);
  frame.colour = colour_of(colour, frame.depth);
  frame.camera = {frame.depth.width(), frame.depth.height(), camera.fx, camera.fy, camera.cx, camera.cy};
  frame.time_s = time_s;
  if (time_s && !std::isfinite(*time_s)) throw UsageError("time: expected a number of seconds");
  return frame;
}

/// An array that keeps what it shows alive.
template <class T>
nb::ndarray<nb::numpy, T> array_of(std::vector<T> values, std::vector<std::size_t> shape) {
  auto* kept = new std::vector<T>(std::move(values));
  const nb::capsule owner(kept, [](void* at) noexcept { delete static_cast<std::vector<T>*>(at); });
  return nb::ndarray<nb::numpy, T>(kept->data(), shape.size(), shape.data(), owner);
}

template <class T>
nb::ndarray<nb::numpy, T> array_of(const Image<T>& image) {
  return array_of(std::vector<T>(image.begin(), image.end()),
                  {static_cast<std::size_t>(image.height()), static_cast<std::size_t>(image.width())});
}

/// A person with the names of parts and joints.
struct PythonPerson {
  Person person;
  std::shared_ptr<const BodyModel> body;
  std::optional<int> id;
  std::string state = "seen";
  std::optional<Eigen::Vector3f> velocity;

  std::size_t set(const std::string& name) const {
    const auto found = std::ranges::find(body->joint_sets, name, &JointSet::name);
    if (found != body->joint_sets.end()) return static_cast<std::size_t>(found - body->joint_sets.begin());
    std::string known;
    for (const JointSet& one : body->joint_sets) known += (known.empty() ? "" : ", ") + one.name;
    throw UsageError("joint set \"" + name + "\": expected one of " + known);
  }
  void append_joints(const std::string& name, std::vector<float>& to) const {
    for (const Joint& joint : person.joints[set(name)]) {
      for (int axis = 0; axis < 3; ++axis) {
        to.push_back(joint.state != State::none ? joint.position[axis] : std::numeric_limits<float>::quiet_NaN());
      }
    }
  }
};

struct PythonPeople {
  std::vector<PythonPerson> people;
  std::shared_ptr<const BodyModel> body;
  int width = 0, height = 0;
};

class PythonDetector {
 public:
  PythonDetector(const std::string& model, int threads, const nb::kwargs& keywords) : threads_(threads) {
    if (threads < 0) throw UsageError("threads: expected 0 (all) or more");
    set_options(options_, keywords);
    const nb::gil_scoped_release released;
    detector_.emplace(load_model(model), options_.detect);
    body_ = std::make_shared<const BodyModel>(detector_->body());
  }

  PythonPeople detect(const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour) const {
    const Frame frame = frame_of(depth, camera, colour, std::nullopt);
    const nb::gil_scoped_release released;
    const ThreadLimit limit(threads_);
    PythonPeople found{{}, body_, frame.camera.width, frame.camera.height};
    for (Person& person : detector_->detect(frame)) found.people.push_back({std::move(person), body_, {}, "seen", {}});
    return found;
  }

  const Detector& detector() const { return *detector_; }
  const PeopleOptions& options() const { return options_; }
  const std::shared_ptr<const BodyModel>& body() const { return body_; }
  int threads() const { return threads_; }

 private:
  int threads_;
  PeopleOptions options_;
  std::optional<Detector> detector_;
  std::shared_ptr<const BodyModel> body_;
};

class PythonTracker {
 public:
  explicit PythonTracker(const PythonDetector& detector)
      : detector_(detector), tracker_(make_tracker(detector.detector(), detector.options())) {}

  PythonPeople update(const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour,
                      std::optional<double> time_s) {
    const Frame frame = frame_of(depth, camera, colour, time_s);
    const nb::gil_scoped_release released;
    const std::scoped_lock lock(mutex_);
    const ThreadLimit limit(detector_.threads());
    const Detection found =
        detector_.detector().detect(frame, [&](const Frame& asked) { return tracker_.expect(asked); });
    const TrackedFrame tracked = tracker_.update(frame, found.people, found.planes);
    PythonPeople people{{}, detector_.body(), frame.camera.width, frame.camera.height};
    for (const TrackedPerson& person : tracked.people) {
      people.people.push_back({person.person, detector_.body(), person.id, to_string(person.state), person.velocity});
    }
    return people;
  }

 private:
  const PythonDetector& detector_;
  std::mutex mutex_;
  PeopleTracker tracker_;
};

/// Masks of people who are not found in the frame are empty.
template <class T>
Image<T> whole(const Image<T>& image, int width, int height, T outside) {
  return image.empty() ? Image<T>(width, height, outside) : image;
}

void bind_people(nb::module_& m) {
  nb::class_<PythonPerson>(m, "Person", "Somebody who was found in a frame.")
      .def_ro("id", &PythonPerson::id, "The id that a Tracker gives and keeps; None from a Detector.")
      .def_ro("state", &PythonPerson::state, "new, tracked, hidden or lost; seen from a Detector.")
      .def_prop_ro(
          "score", [](const PythonPerson& p) { return p.person.score; }, "How certain it is, 0 to 1.")
      .def_prop_ro(
          "box",
          [](const PythonPerson& p) {
            const Box& b = p.person.box;
            return std::vector<int>{b.u, b.v, b.width, b.height};
          },
          "Column, row, width and height of the smallest box around the mask, pixels.")
      .def_prop_ro(
          "yaw",
          [](const PythonPerson& p) {
            return p.person.yaw ? std::optional(p.person.yaw->yaw_rad) : std::optional<float>();
          },
          "Which way the person faces, radians: 0 the camera, positive turned to the person's own left; None if "
          "unknown.")
      .def_prop_ro(
          "velocity",
          [](const PythonPerson& p) -> std::optional<std::vector<float>> {
            if (!p.velocity) return std::nullopt;
            return std::vector<float>{p.velocity->x(), p.velocity->y(), p.velocity->z()};
          },
          "Of the trunk, metres a second, optical frame; None from a Detector.")
      .def_prop_ro(
          "mask", [](const PythonPerson& p) { return array_of(p.person.mask); }, nb::rv_policy::automatic,
          "uint8 (height, width): 1 on the person's pixels; empty where the person is not found.")
      .def_prop_ro(
          "labels", [](const PythonPerson& p) { return array_of(p.person.labels); }, nb::rv_policy::automatic,
          "uint8 (height, width): part of each of the person's pixels, 255 elsewhere (Detector.parts).")
      .def(
          "joints",
          [](const PythonPerson& p, const std::string& set) {
            std::vector<float> values;
            p.append_joints(set, values);
            return array_of(std::move(values), {p.person.joints[p.set(set)].size(), 3});
          },
          "set"_a = "k4abt32",
          "float32 (joints, 3): metres, optical frame (x right, y down, z away); NaN where unknown.")
      .def(
          "confidences",
          [](const PythonPerson& p, const std::string& set) {
            std::vector<float> values;
            for (const Joint& joint : p.person.joints[p.set(set)]) values.push_back(joint.confidence);
            const std::size_t count = values.size();
            return array_of(std::move(values), {count});
          },
          "set"_a = "k4abt32", "float32 (joints,): 0 to 1.")
      .def(
          "states",
          [](const PythonPerson& p, const std::string& set) {
            std::vector<std::string> states;
            for (const Joint& joint : p.person.joints[p.set(set)]) states.emplace_back(to_string(joint.state));
            return states;
          },
          "set"_a = "k4abt32", "For each joint: observed, predicted or none.")
      .def("__repr__", [](const PythonPerson& p) {
        return "<vesalius.Person" + (p.id ? " " + std::to_string(*p.id) : std::string()) + " " + p.state + ", score " +
               std::to_string(p.person.score) + ">";
      });
  nb::class_<PythonPeople>(m, "People", "The people of a frame: a sequence, and arrays over all of them.")
      .def("__len__", [](const PythonPeople& p) { return p.people.size(); })
      .def(
          "__getitem__",
          [](const PythonPeople& p, std::ptrdiff_t i) -> const PythonPerson& {
            const auto count = static_cast<std::ptrdiff_t>(p.people.size());
            if (i < 0) i += count;
            if (i < 0 || i >= count) throw nb::index_error();
            return p.people[static_cast<std::size_t>(i)];
          },
          nb::rv_policy::reference_internal)
      .def(
          "joints",
          [](const PythonPeople& p, const std::string& set) {
            std::vector<float> values;
            for (const PythonPerson& person : p.people) person.append_joints(set, values);
            const PythonPerson nobody{{}, p.body, {}, "", {}};
            return array_of(std::move(values), {p.people.size(), p.body->joint_sets[nobody.set(set)].joints.size(), 3});
          },
          "set"_a = "k4abt32", "float32 (people, joints, 3): metres, optical frame; NaN where unknown.")
      .def_prop_ro(
          "masks",
          [](const PythonPeople& p) {
            std::vector<std::uint8_t> values;
            for (const PythonPerson& person : p.people) {
              const Mask mask = whole(person.person.mask, p.width, p.height, std::uint8_t{0});
              values.insert(values.end(), mask.begin(), mask.end());
            }
            return array_of(std::move(values),
                            {p.people.size(), static_cast<std::size_t>(p.height), static_cast<std::size_t>(p.width)});
          },
          nb::rv_policy::automatic, "uint8 (people, height, width): 1 on each person's pixels.")
      .def_prop_ro(
          "ids",
          [](const PythonPeople& p) {
            std::vector<std::optional<int>> ids;
            for (const PythonPerson& person : p.people) ids.push_back(person.id);
            return ids;
          },
          "The people's ids, None from a Detector.");
}

}  // namespace

NB_MODULE(_vesalius, m) {
  m.attr("__version__") = VESALIUS_VERSION;
  const nb::exception<Error> error(m, "Error", PyExc_RuntimeError);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void* /*unused*/) {
    try {
      std::rethrow_exception(thrown);
    } catch (const UsageError& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    }
  });
  m.def("options", &describe_options,
        "The options that Detector takes as keywords: a line each with default, unit and what it is.");
  nb::class_<PythonCamera>(m, "Camera",
                           "The pinhole camera of the depth picture, pixels; pixel centres are whole numbers.")
      .def(nb::init<float, float, float, float>(), "fx"_a, "fy"_a, "cx"_a, "cy"_a)
      .def_rw("fx", &PythonCamera::fx)
      .def_rw("fy", &PythonCamera::fy)
      .def_rw("cx", &PythonCamera::cx)
      .def_rw("cy", &PythonCamera::cy);
  bind_people(m);
  nb::class_<PythonDetector>(m, "Detector",
                             "Finds the people in one frame at a time. It may be used from several threads.")
      .def(nb::init<const std::string&, int, const nb::kwargs&>(), "model"_a, "threads"_a = 0, "options"_a)
      .def("detect", &PythonDetector::detect, "depth"_a, "camera"_a, "colour"_a = nb::none(),
           "Finds the people in a depth picture: (height, width) uint16 in millimetres or float32 in metres; 0, and of "
           "float32 what is no number, is no reading. colour: (height, width, 3) uint8, registered to depth. Returns "
           "People, the most certain first. Raises ValueError for arrays or options that do not fit, Error otherwise.")
      .def_prop_ro(
          "parts",
          [](const PythonDetector& d) {
            std::vector<std::string> names;
            for (const BodyPart& part : d.body()->parts) names.push_back(part.name);
            return names;
          },
          "Names of the parts, by their numbers in Person.labels.")
      .def_prop_ro(
          "joint_sets",
          [](const PythonDetector& d) {
            std::vector<std::string> names;
            for (const JointSet& set : d.body()->joint_sets) names.push_back(set.name);
            return names;
          },
          "Names of the joint sets.")
      .def(
          "joint_names",
          [](const PythonDetector& d, const std::string& set) {
            const PythonPerson nobody{{}, d.body(), {}, "", {}};
            std::vector<std::string> names;
            for (const JointDefinition& joint : d.body()->joint_sets[nobody.set(set)].joints)
              names.push_back(joint.name);
            return names;
          },
          "set"_a = "k4abt32", "Names of a set's joints, in their order.");
  nb::class_<PythonTracker>(m, "Tracker", "Follows people over the frames of one source: ids that hold, fitted bodies.")
      .def(nb::init<const PythonDetector&>(), "detector"_a, nb::keep_alive<1, 2>())
      .def("update", &PythonTracker::update, "depth"_a, "camera"_a, "colour"_a = nb::none(), "time"_a = nb::none(),
           "Takes the next frame, as Detector.detect, at a time in seconds (without times frames are 1/30 s apart). "
           "Returns People by their ids; hidden ones are among them.");
}

}  // namespace vesalius
