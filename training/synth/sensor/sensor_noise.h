#pragma once

#include <cstdint>
#include <optional>

#include "synth/sensor/render.h"
#include "synth/sensor/sensor.h"
#include "vesalius/base/random.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// Returns the position of the sensor's projector or second eye in the camera frame, or nothing if it has none.
std::optional<Eigen::Vector3f> projector_of(const Sensor& sensor);

/// Draws the border of one camera, so that it is the same in all frames of a recording.
void settle_border(Sensor& sensor, Random random);

/// Returns depth as the sensor reports it: uint16 millimetres, 0 = no reading. The same (rendering, sensor, random)
/// gives the same bytes. Silhouettes wobble and grow, and the truth must follow: `source`, if not null, receives for
/// each pixel the pixel (row-major index) of the rendering whose surface was read, to be used with `as_read`; it is the
/// pixel itself if nothing was read. Throws Error if the images of the rendering differ in size, or `lit` is missing
/// for a sensor with a projector.
DepthImage sense(const Rendering& rendering, const Sensor& sensor, Random random,
                 Image<std::uint32_t>* source = nullptr);

/// Returns the labels or person indices of the surfaces that were read.
template <class T>
Image<T> as_read(const Image<T>& image, const Image<std::uint32_t>& source) {
  Image<T> read(image.width(), image.height());
  for (std::size_t i = 0; i < read.size(); ++i) read[i] = image[source[i]];
  return read;
}

}  // namespace vesalius::synth
