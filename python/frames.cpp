#include "frames.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "pictures.h"
#include "stream/json_numbers.h"
#include "vesalius/error.h"
#include "vesalius/open_source.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace vesalius {
namespace {

/// Shows values of a frame, which lives as long as the array.
template <class T>
nb::ndarray<nb::numpy, T> view_of(const std::shared_ptr<Frame>& frame, T* values, std::vector<std::size_t> shape) {
  auto* kept = new std::shared_ptr<Frame>(frame);
  const nb::capsule owner(kept, [](void* at) noexcept { delete static_cast<std::shared_ptr<Frame>*>(at); });
  return nb::ndarray<nb::numpy, T>(values, shape.size(), shape.data(), owner);
}

std::vector<std::size_t> shape_of(const Camera& camera) {
  return {static_cast<std::size_t>(camera.height), static_cast<std::size_t>(camera.width)};
}

nb::ndarray<nb::numpy, std::uint16_t> depth_of(const PythonFrame& f) {
  return view_of(f.frame, f.frame->depth.data(), shape_of(f.frame->camera));
}

std::optional<nb::ndarray<nb::numpy, std::uint8_t>> colour_of(const PythonFrame& f) {
  if (f.frame->colour.empty()) return std::nullopt;
  std::vector<std::size_t> shape = shape_of(f.frame->camera);
  shape.push_back(3);
  return view_of(f.frame, reinterpret_cast<std::uint8_t*>(f.frame->colour.data()), std::move(shape));
}

/// A source that threads may share: each frame goes to one of them.
class PythonSource {
 public:
  PythonSource(const std::string& uri, const SourceOptions& options) : source_(open_source(uri, options)) {}

  PythonFrame next() {
    std::optional<Frame> frame;
    {
      const nb::gil_scoped_release released;
      const std::scoped_lock lock(mutex_);
      if (!stopped_) frame = source_->next();
    }
    if (!frame) throw nb::stop_iteration();
    return {std::make_shared<Frame>(std::move(*frame))};
  }
  std::optional<int> size() const {
    const int size = source_->size();
    return size < 0 ? std::nullopt : std::optional(size);
  }
  std::vector<std::string> notes() const { return source_->notes(); }
  bool is_live() const { return source_->is_live(); }
  int missed() const { return source_->missed(); }
  /// `stop` is the one call that need not wait for `next`.
  void stop() {
    stopped_ = true;
    source_->stop();
  }

 private:
  std::mutex mutex_;
  std::atomic<bool> stopped_ = false;
  std::unique_ptr<FrameSource> source_;
};

DepthBits depth_bits_named(const std::string& name) {
  if (name == "plain") return DepthBits::plain;
  if (name == "swapped") return DepthBits::swapped;
  if (name == "rotated") return DepthBits::rotated;
  throw UsageError("depth_bits is \"" + name + "\", expected \"plain\", \"swapped\" or \"rotated\"");
}

std::string text_of(float value) { return nb::cast<std::string>(nb::repr(nb::float_(shortest(value)))); }

std::string path_of(const nb::handle& path) {
  return nb::cast<std::string>(nb::module_::import_("os").attr("fspath")(path));
}

std::shared_ptr<PythonSource> open(const nb::object& source, std::optional<float> fx, std::optional<float> fy,
                                   std::optional<float> cx, std::optional<float> cy, std::optional<float> depth_scale,
                                   const nb::object& camera_file, const nb::object& colour_file,
                                   const std::string& depth_topic, const std::string& colour_topic,
                                   std::optional<double> start, bool reconnect, const std::string& depth_bits,
                                   std::optional<int> turn) {
  SourceOptions options;
  options.fx = fx;
  options.fy = fy;
  options.cx = cx;
  options.cy = cy;
  options.depth_scale = depth_scale;
  if (!camera_file.is_none()) options.camera_file = path_of(camera_file);
  if (!colour_file.is_none()) options.colour_file = path_of(colour_file);
  options.depth_topic = depth_topic;
  options.colour_topic = colour_topic;
  options.start_s = start;
  options.reconnect = reconnect;
  options.depth_bits = depth_bits_named(depth_bits);
  options.turn = turn;
  const std::string uri = path_of(source);
  const nb::gil_scoped_release released;
  return std::make_shared<PythonSource>(uri, options);
}

void bind_frame(nb::module_& m) {
  nb::class_<PythonFrame>(m, "Frame", "One picture of a depth camera: depth, and colour registered to it or none.")
      .def(
          "__init__",
          [](PythonFrame* self, const AnyArray& depth, const PythonCamera& camera,
             const std::optional<AnyArray>& colour, std::optional<double> time,
             const std::optional<std::array<float, 3>>& up, const std::string& name, std::optional<int> turn) {
            auto frame = std::make_shared<Frame>(frame_of(depth, camera, colour, time));
            frame->name = name;
            if (up) {
              const Eigen::Vector3f given(up->data());
              if (!(given.norm() > 0.F) || !given.allFinite())
                throw UsageError("up: expected a direction of 3 numbers");
              frame->up = given.normalized();
            }
            if (turn) {
              if (*turn % 90 != 0 || *turn < 0 || *turn > 270) throw UsageError("turn: expected 0, 90, 180 or 270");
              frame->quarter_turns = *turn / 90;
            }
            new (self) PythonFrame{std::move(frame)};
          },
          "depth"_a, "camera"_a, "colour"_a = nb::none(), "time"_a = nb::none(), "up"_a = nb::none(), "name"_a = "",
          "turn"_a = nb::none(),
          "depth: (height, width) uint16 in millimetres or float32 in metres; 0, and of float32 what is no number, is "
          "no reading. colour: (height, width, 3) uint8. Both are copied. time: seconds. up: direction away from the "
          "ground, optical frame. turn: degrees clockwise, 0, 90, 180 or 270, that make the picture upright; None: as "
          "up "
          "tells. Raises ValueError for what does not fit.")
      .def_prop_ro(
          "name", [](const PythonFrame& f) { return f.frame->name; }, "File stem or time stamp.")
      .def_prop_ro(
          "time", [](const PythonFrame& f) { return f.frame->time_s; },
          "Seconds since any moment the source counts from; None where it has no times.")
      .def_prop_ro(
          "camera", [](const PythonFrame& f) { return PythonCamera(f.frame->camera); },
          "The pinhole camera of the depth picture.")
      .def_prop_ro("depth", &depth_of, nb::rv_policy::automatic,
                   "uint16 (height, width): millimetres, 0 where there is no reading. The frame's own values, no copy.")
      .def_prop_ro("colour", &colour_of, nb::rv_policy::automatic,
                   "uint8 (height, width, 3): red, green, blue, registered to depth; None without. No copy.")
      .def_prop_ro(
          "up",
          [](const PythonFrame& f) -> std::optional<std::array<float, 3>> {
            if (!f.frame->up) return std::nullopt;
            return std::array<float, 3>{f.frame->up->x(), f.frame->up->y(), f.frame->up->z()};
          },
          "Unit vector away from the ground, optical frame, as the camera measured it; None without.")
      .def("__repr__", [](const PythonFrame& f) {
        const Camera& camera = f.frame->camera;
        return "<vesalius.Frame " + f.frame->name + ", " + std::to_string(camera.width) + "x" +
               std::to_string(camera.height) + (f.frame->colour.empty() ? ">" : " with colour>");
      });
}

void bind_source(nb::module_& m) {
  nb::class_<PythonSource>(m, "Source", "Frames of a folder, a recording or a camera: an iterator (vesalius.open).")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); }, nb::sig("def __iter__(self) -> Source"))
      .def("__next__", &PythonSource::next)
      .def(
          "__enter__", [](nb::handle self) { return nb::borrow(self); }, nb::sig("def __enter__(self) -> Source"))
      .def(
          "__exit__",
          [](PythonSource& source, const nb::object& /*type*/, const nb::object& /*value*/,
             const nb::object& /*traceback*/) { source.stop(); },
          nb::arg().none(), nb::arg().none(), nb::arg().none())
      .def("stop", &PythonSource::stop,
           "Ends the iteration, from any thread; a camera that is waited for gives up soon.")
      .def_prop_ro("size", &PythonSource::size, "Number of all frames; None where it is not known.")
      .def_prop_ro("notes", &PythonSource::notes, "Remarks, a line each, such as guessed intrinsics.")
      .def_prop_ro("is_live", &PythonSource::is_live, "Whether a camera gives the frames as they are taken.")
      .def_prop_ro("missed", &PythonSource::missed, "Frames of a camera that nobody asked for in time.");
  m.def(
      "open", &open, "source"_a, nb::kw_only(), "fx"_a = nb::none(), "fy"_a = nb::none(), "cx"_a = nb::none(),
      "cy"_a = nb::none(), "depth_scale"_a = nb::none(), "camera_file"_a = nb::none(), "colour_file"_a = nb::none(),
      "depth_topic"_a = "", "colour_topic"_a = "", "start"_a = nb::none(), "reconnect"_a = false,
      "depth_bits"_a = "plain", "turn"_a = nb::none(),
      nb::sig("def open(source: str | os.PathLike[str], *, fx: float | None = None, fy: float | None = None, "
              "cx: float | None = None, cy: float | None = None, depth_scale: float | None = None, "
              "camera_file: str | os.PathLike[str] | None = None, colour_file: str | os.PathLike[str] | None = None, "
              "depth_topic: str = '', colour_topic: str = '', start: float | None = None, reconnect: bool = False, "
              "depth_bits: str = 'plain', turn: int | None = None) -> Source"),
      "Opens frames: the path of a folder, a picture or a recording, or a camera such as \"realsense:\", as the "
      "program does (docs/recordings.md, docs/cameras.md). fx, fy, cx, cy: pixels; depth_scale: stored units per "
      "metre; camera_file: meta.json or ROS camera_info; colour_file: of a single depth picture; depth_topic, "
      "colour_topic: of a recording; start: seconds after the first frame; reconnect: wait for a camera that is lost; "
      "depth_bits: \"swapped\" bytes or \"rotated\" by three bits, as in SUN RGB-D; turn: degrees clockwise, 0, 90, "
      "180 or "
      "270, that make the pictures upright (default: as gravity tells, where it is measured): results stay in the "
      "camera's own pictures and axes. "
      "Returns an iterator of Frame. Raises Error for what cannot be read, there and in the iteration, which can go "
      "on with the next frame.");
}

}  // namespace

void bind_frames(nb::module_& m) {
  nb::class_<PythonCamera>(m, "Camera",
                           "The pinhole camera of the depth picture, pixels; pixel centres are whole numbers.")
      .def(nb::init<float, float, float, float>(), "fx"_a, "fy"_a, "cx"_a, "cy"_a)
      .def_rw("fx", &PythonCamera::fx)
      .def_rw("fy", &PythonCamera::fy)
      .def_rw("cx", &PythonCamera::cx)
      .def_rw("cy", &PythonCamera::cy)
      .def(
          "project",
          [](const PythonCamera& c, nb::handle points) {
            const nb::module_ numpy = nb::module_::import_("numpy");
            return project(c.of(0, 0), nb::cast<Places>(numpy.attr("asarray")(points, numpy.attr("float64"))));
          },
          "points"_a,
          nb::sig("def project(self, points: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]"),
          "float64 (..., 2): columns and rows of the pixels in which the camera sees points (..., 3) in metres, "
          "optical "
          "frame; NaN for those that are NaN or not in front of it.")
      .def("__repr__", [](const PythonCamera& c) {
        return "<vesalius.Camera fx=" + text_of(c.fx) + ", fy=" + text_of(c.fy) + ", cx=" + text_of(c.cx) +
               ", cy=" + text_of(c.cy) + ">";
      });
  bind_frame(m);
  bind_source(m);
}

}  // namespace vesalius
