#include "eval/shrink_frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "vesalius/error.h"

namespace vesalius {
namespace {

template <class T>
Image<T> every_nth(const Image<T>& image, int factor) {
  Image<T> small(image.width() / factor, image.height() / factor);
  for (int v = 0; v < small.height(); ++v) {
    for (int u = 0; u < small.width(); ++u) small(u, v) = image(u * factor, v * factor);
  }
  return small;
}

}  // namespace

Frame shrink(const Frame& frame, int factor) {
  if (factor < 1 || frame.camera.width < factor || frame.camera.height < factor) {
    throw Error(fmt::format("frame {}: {}x{} pixels cannot be shrunk by {}", frame.name, frame.camera.width,
                            frame.camera.height, factor));
  }
  const Camera& c = frame.camera;
  const auto step = static_cast<float>(factor);
  Frame small;
  small.name = frame.name;
  small.time_s = frame.time_s;
  // Pixel u of the new grid is pixel factor * u of the old one, so that each keeps its ray.
  small.camera = {c.width / factor, c.height / factor, c.fx / step, c.fy / step, c.cx / step, c.cy / step};
  small.depth = every_nth(frame.depth, factor);
  if (!frame.colour.empty()) small.colour = every_nth(frame.colour, factor);
  return small;
}

Image<std::uint8_t> shrink(const Image<std::uint8_t>& image, int factor) { return every_nth(image, factor); }

Image<std::uint8_t> enlarge(const Image<std::uint8_t>& image, int factor, int width, int height) {
  Image<std::uint8_t> large(width, height);
  for (int v = 0; v < height; ++v) {
    const int row = std::min(v / factor, image.height() - 1);
    for (int u = 0; u < width; ++u) large(u, v) = image(std::min(u / factor, image.width() - 1), row);
  }
  return large;
}

void enlarge(std::vector<Person>& people, int factor, int width, int height) {
  for (Person& person : people) {
    person.mask = enlarge(person.mask, factor, width, height);
    person.labels = enlarge(person.labels, factor, width, height);
    Box& box = person.box;
    box = {box.u * factor, box.v * factor, box.width * factor, box.height * factor};
  }
}

void enlarge(Trace& trace, int factor, int width, int height) {
  trace.labels = enlarge(trace.labels, factor, width, height);
  for (Trace::Candidate& candidate : trace.candidates) {
    candidate.grown = enlarge(candidate.grown, factor, width, height);
  }
}

}  // namespace vesalius
