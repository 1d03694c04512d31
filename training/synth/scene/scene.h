#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "synth/mesh/scene_mesh.h"
#include "vesalius/camera.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// A point light.
struct Light {
  Eigen::Vector3f position = Eigen::Vector3f(0.F, 2.4F, 0.F);
  float strength = 1.F;  ///< brightness, 0-1, of a white surface that faces it at 1 m
};

/// All surfaces and lights.
struct Scene {
  std::vector<SceneMesh> meshes;
  std::vector<Light> lights;
  float ambient = 0.35F;  ///< brightness of a white surface that no light reaches
  Rgb sky{0, 0, 0};       ///< colour of pixels without a surface, as through windows
};

/// A camera in the world. In the camera frame x points right, y down, z forward.
struct View {
  Camera camera;
  Eigen::Isometry3f camera_from_world = Eigen::Isometry3f::Identity();
};

}  // namespace vesalius::synth
