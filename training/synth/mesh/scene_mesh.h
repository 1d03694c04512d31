#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "synth/body/body_mesh.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// The pattern of a surface, as a function of the position on it.
enum class Texture : std::uint8_t { plain, stripes, checks, speckle };

/// The appearance of a surface to the colour camera and the depth sensor.
struct Material {
  Rgb colour{180, 180, 180};
  Rgb second{180, 180, 180};  ///< second colour of the pattern
  Texture texture = Texture::plain;
  float period_m = 0.1F;  ///< period of the pattern
  float infrared = 0.6F;  ///< reflected share of the sensor's light, 0-1; dark hair and black plastic are near 0.05
};

/// A surface in the world (y up, floor at y = 0, metres).
struct SceneMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> part;      ///< for each triangle; empty if all are kBackground
  std::vector<std::uint8_t> material;  ///< for each triangle, an index in `materials`; empty if all are 0
  std::vector<Material> materials;
  int person = -1;  ///< index of the person, or -1; a person's triangles of part kBackground count as nobody's
};

}  // namespace vesalius::synth
