#include "vesalius/frame.h"

#include "vesalius/error.h"

namespace vesalius {

void check(const Frame& frame) {
  check(frame.camera);
  const auto size = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  if (frame.depth.width() != frame.camera.width || frame.depth.height() != frame.camera.height) {
    throw Error("frame " + frame.name + ": depth is " + size(frame.depth.width(), frame.depth.height()) +
                ", expected the camera's " + size(frame.camera.width, frame.camera.height));
  }
  if (!frame.colour.empty() && !frame.colour.same_size(frame.depth)) {
    throw Error("frame " + frame.name + ": colour is " + size(frame.colour.width(), frame.colour.height()) +
                ", expected the size of the depth, " + size(frame.depth.width(), frame.depth.height()));
  }
}

const char* to_string(State state) {
  switch (state) {
    case State::predicted:
      return "predicted";
    case State::observed:
      return "observed";
    default:
      return "none";
  }
}

}  // namespace vesalius
