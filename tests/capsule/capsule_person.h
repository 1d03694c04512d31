#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "capsule/capsule_shape.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// Joint angles of a capsule person, in radians. With all of them zero the person stands upright, faces the camera, and
/// the arms hang just clear of the trunk. Left and right are the person's own. Soles stay level.
struct CapsulePose {
  float yaw = 0.F;        ///< about the vertical axis; positive turns the person to their own left
  float lean = 0.F;       ///< trunk forward (positive) or backward
  float side_lean = 0.F;  ///< trunk towards the person's left
  float head_yaw = 0.F;
  float head_pitch = 0.F;  ///< positive looks down
  struct Arm {
    float raise = 0.F;    ///< sideways from the trunk; 0 hangs, pi/2 is horizontal
    float forward = 0.F;  ///< swing to the front
    float elbow = 0.F;    ///< flexion, 0 straight
  } l_arm, r_arm;
  struct Leg {
    float spread = 0.F;   ///< sideways
    float forward = 0.F;  ///< thigh to the front, pi/2 = sitting
    float knee = 0.F;     ///< flexion, 0 straight
  } l_leg, r_leg;
};

/// The size and clothes of a person.
struct CapsuleBuild {
  float stature_m = 1.75F;  ///< 0.5 to 2.5
  float girth = 1.F;        ///< multiplies all radii except the head's; 0.5 to 1.5
  Rgb skin{224, 172, 138}, hair{60, 42, 30}, shirt{52, 101, 164}, trousers{60, 60, 70}, shoes{30, 30, 30};
};

/// A standing person. `feet` is the point on the ground between the ankles, in metres in the optical frame of a camera
/// whose y axis points down. The person stands upright along -y with the lower sole on the ground.
struct CapsulePerson {
  CapsuleBuild build;
  CapsulePose pose;
  Eigen::Vector3f feet = Eigen::Vector3f(0.F, 1.F, 2.5F);
};

/// One solid of a person's body. `split` (along its axis, shape units) and the plane x = 0 cut it into four pieces,
/// each of which carries a part of the paper's body.
struct BodySolid {
  CapsuleShape shape;
  double split = 0.0;
  std::array<std::array<int, 2>, 2> part{};  ///< [0: below or at the split, 1: above][0: x < 0, 1: x >= 0], 0-24
  Rgb colour;
  Rgb crown;  ///< colour of the top and back; differs from `colour` only on the head

  int part_at(const Eigen::Vector3d& local) const { return part[local.y() > split][local.x() >= 0.0]; }
};

/// Returns the person's solids, in the world. Lengths are fractions of the stature after Drillis and Contini (1966).
/// Throws Error for a build out of range or a number that is not finite.
std::vector<BodySolid> make_solids(const CapsulePerson& person);

/// Returns the centre of the volume of each of the paper's parts, metres, world. Where solids overlap, both count.
std::vector<Eigen::Vector3d> part_centres(const std::vector<BodySolid>& solids);

/// A solid box with a colour, axis-aligned in the world: furniture, pillars, occluders.
struct SceneBox {
  Eigen::Vector3f low, high;
  Rgb colour{150, 120, 90};
};

/// People in a plain room: the truth for tests, tools and benchmarks. The world is the optical frame of a level camera
/// at the origin; `pitch` turns the camera down (positive) or up.
struct CapsuleScene {
  std::vector<CapsulePerson> people;
  std::vector<SceneBox> boxes;
  float floor_y_m = 1.F;      ///< height of the camera above the floor; <= 0: no floor
  float wall_z_m = 4.5F;      ///< back wall; <= 0: no wall
  float side_wall_x_m = 0.F;  ///< walls at +- this; <= 0: none
  float pitch = 0.F;          ///< camera pitch, radians
  Rgb floor_colour{120, 100, 80}, wall_colour{200, 195, 185};
};

/// Renders the scene by ray casting: exact depth (rounded to the millimetre, 0 beyond 65.535 m), labels, person index,
/// part centres (camera frame) and shaded colour. Labels are those of `body`, matched by part name; surfaces whose part
/// the body lacks take the nearest part up the paper body's tree that it has, or background. The centre of a part that
/// no surface carries is NaN. The picture is the same for any number of threads. Throws Error for a camera, build or
/// number out of range, or more than 255 people.
LabelledFrame render(const CapsuleScene& scene, const Camera& camera, const BodyModel& body);

/// Turns exact depth into what a structured-light sensor reports: axial and lateral noise (Nguyen, Izadi, Lovell 2012),
/// disparity in steps of 1/8 pixel, and no reading in the projector's shadow, on half of the silhouettes, where the
/// surface is seen at a grazing angle, within 1/80 of the width of the left and right border, and outside 0.4-10 m. The
/// same frame and seed give the same bytes.
void add_sensor_noise(Frame& frame, std::uint64_t seed);

}  // namespace vesalius
