#pragma once

#include <cstdint>
#include <optional>

#include "synth/sensor/render.h"
#include "synth/sensor/sensor.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns where the sensor's projector or second eye sits, in the camera frame; nothing for sensors that have none.
std::optional<Eigen::Vector3f> projector_of(const Sensor& sensor);

/// Returns depth as the sensor reports it: uint16 millimetres, 0 = no reading. Same (rendering, sensor, random), same
/// bytes. `source`, if asked for, is given the pixel (row-major index) of the rendering whose surface was read, for
/// silhouettes wobble and grow and the truth must follow (`as_read`); the pixel itself where nothing was read.
/// Throws Error when the images of the rendering differ in size, or `lit` is missing for a sensor with a projector.
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
