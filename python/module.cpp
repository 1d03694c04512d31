// The Python module vesalius._vesalius. Everything that takes long runs without the interpreter's lock.

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "frames.h"
#include "options_from_keywords.h"
#include "people.h"
#include "plain_calls.h"
#include "vesalius/body_model.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"
#include "vesalius/track_people.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace vesalius {
namespace {

/// Returns what people keep of their frame.
Frame without_pictures(const Frame& frame) { return {frame.name, frame.time_s, frame.camera, {}, {}, {}, frame.up}; }

class PythonDetector {
 public:
  PythonDetector(const std::string& model, int threads, const nb::kwargs& keywords) : threads_(threads) {
    if (threads < 0) throw UsageError("threads: expected 0 (all) or more");
    set_options(options_, keywords);
    const nb::gil_scoped_release released;
    detector_.emplace(load_model(model), options_.detect);
    body_ = std::make_shared<const BodyModel>(detector_->body());
  }

  PythonPeople detect(const std::shared_ptr<const Frame>& frame) const {
    const nb::gil_scoped_release released;
    const ThreadLimit limit(threads_);
    return {std::make_shared<FoundPeople>(
        FoundPeople{without_pictures(*frame), body_, seen_people(detector_->detect(*frame)), frame})};
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

  PythonPeople update(const std::shared_ptr<const Frame>& frame) {
    const nb::gil_scoped_release released;
    const std::scoped_lock lock(mutex_);
    const ThreadLimit limit(detector_.threads());
    return {std::make_shared<FoundPeople>(FoundPeople{without_pictures(*frame), detector_.body(),
                                                      follow(detector_.detector(), tracker_, *frame), frame})};
  }

 private:
  const PythonDetector& detector_;
  std::mutex mutex_;
  PeopleTracker tracker_;
};

void bind_detector(nb::module_& m) {
  nb::class_<PythonDetector>(m, "Detector",
                             "Finds the people in one frame at a time. It may be used from several threads.")
      .def(nb::init<const std::string&, int, const nb::kwargs&>(), "model"_a, "threads"_a = 0, "options"_a,
           nb::sig("def __init__(self, model: str, threads: int = 0, **options: float | int | bool | str) -> None"))
      .def(
          "detect", [](const PythonDetector& d, const PythonFrame& frame) { return d.detect(frame.frame); }, "frame"_a,
          "Finds the people in a frame, without copying its pictures. Returns People, the most certain first. Raises "
          "Error for a frame or a camera that cannot be.")
      .def(
          "detect",
          [](const PythonDetector& d, const AnyArray& depth, const PythonCamera& camera,
             const std::optional<AnyArray>& colour) {
            return d.detect(std::make_shared<Frame>(frame_of(depth, camera, colour, std::nullopt)));
          },
          "depth"_a, "camera"_a, "colour"_a = nb::none(),
          "Finds the people in a depth picture: (height, width) uint16 in millimetres or float32 in metres; 0, and of "
          "float32 what is no number, is no reading. colour: (height, width, 3) uint8, registered to depth. Returns "
          "People, the most certain first. Raises ValueError for arrays or options that do not fit, Error otherwise.")
      .def_prop_ro(
          "parts", [](const PythonDetector& d) { return names_of(d.body()->parts); },
          "Names of the parts, by their numbers in Person.labels.")
      .def(
          "options", [](const PythonDetector& d) { return options_as_dict(d.options()); },
          nb::sig("def options(self) -> dict[str, float | int | bool | str]"), "All options with their values.")
      .def_prop_ro(
          "joint_sets", [](const PythonDetector& d) { return names_of(d.body()->joint_sets); },
          "Names of the joint sets.")
      .def(
          "joint_names",
          [](const PythonDetector& d, const std::string& set) {
            return names_of(d.body()->joint_sets[find_joint_set(*d.body(), set)].joints);
          },
          "set"_a = "k4abt32", "Names of a set's joints, in their order.");
  nb::class_<PythonTracker>(m, "Tracker", "Follows people over the frames of one source: ids that hold, fitted bodies.")
      .def(nb::init<const PythonDetector&>(), "detector"_a, nb::keep_alive<1, 2>())
      .def(
          "update", [](PythonTracker& t, const PythonFrame& frame) { return t.update(frame.frame); }, "frame"_a,
          "Takes the next frame, without copying its pictures. Returns People by their ids; hidden ones are among "
          "them.")
      .def(
          "update",
          [](PythonTracker& t, const AnyArray& depth, const PythonCamera& camera, const std::optional<AnyArray>& colour,
             std::optional<double> time) {
            return t.update(std::make_shared<Frame>(frame_of(depth, camera, colour, time)));
          },
          "depth"_a, "camera"_a, "colour"_a = nb::none(), "time"_a = nb::none(),
          "Takes the next frame, as Detector.detect, at a time in seconds (without times frames are 1/30 s apart). "
          "Returns People by their ids; hidden ones are among them.");
}

}  // namespace

NB_MODULE(_vesalius, m) {
  m.attr("VERSION") = VESALIUS_VERSION;
  const nb::exception<Error> error(m, "Error", PyExc_RuntimeError);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void* /*unused*/) {
    try {
      std::rethrow_exception(thrown);
    } catch (const UsageError& e) {
      PyErr_SetString(PyExc_ValueError, e.what());
    }
  });
  m.def(
      "options", [] { return options_as_dict({}); }, nb::sig("def options() -> dict[str, float | int | bool | str]"),
      "The options that Detector takes as keywords, with their defaults.");
  m.def("describe_options", &describe_options,
        "The options that Detector takes as keywords: a line each with default, unit and what it is.");
  bind_frames(m);
  bind_people(m);
  bind_detector(m);
  bind_plain_calls(m);
}

}  // namespace vesalius
