#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "synth/body/body_mesh.h"
#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"

namespace vesalius::synth {

/// Pattern of a surface, a function of the position on it.
enum class Texture : std::uint8_t { plain, stripes, checks, speckle };

/// How a surface looks to the colour camera and to the depth sensor.
struct Material {
  Rgb colour{180, 180, 180};
  Rgb second{180, 180, 180};  ///< of the pattern
  Texture texture = Texture::plain;
  float period_m = 0.1F;  ///< of the pattern
  float infrared = 0.6F;  ///< share of the sensor's light sent back, 0-1: dark hair and black plastic near 0.05
};

/// A surface of the world (y up, floor at y = 0, metres).
struct SceneMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> part;      ///< per triangle, or empty: all kBackground
  std::vector<std::uint8_t> material;  ///< per triangle, index in `materials`, or empty: all 0
  std::vector<Material> materials;
  int person = -1;  ///< index of the person, -1: no person; triangles of a person with part kBackground count as none
};

/// Point light.
struct Light {
  Eigen::Vector3f position = Eigen::Vector3f(0.F, 2.4F, 0.F);
  float strength = 1.F;  ///< brightness of a white surface facing it at 1 m, 0-1 scale
};

/// Everything there is to see.
struct Scene {
  std::vector<SceneMesh> meshes;
  std::vector<Light> lights;
  float ambient = 0.35F;  ///< brightness of a white surface without any light
  Rgb sky{0, 0, 0};       ///< what colour pictures show where there is no surface: through windows
};

/// A camera standing in the world. camera frame: x right, y down, z forward.
struct View {
  Camera camera;
  Eigen::Isometry3f camera_from_world = Eigen::Isometry3f::Identity();
};

}  // namespace vesalius::synth
