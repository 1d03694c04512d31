#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius::test {

/// Somebody who walks about on a floor 1 m below the first camera, y pointing down.
struct Walker {
  Eigen::Vector3f from{0.F, 0.F, 3.F}, velocity = Eigen::Vector3f::Zero();
  float heading_rad = 0.F, turn_rad_s = 0.F;
};

/// Returns the joints of a walker, in the first camera's frame: 15 points of a body that is not symmetrical, since it
/// swings its arms.
inline std::vector<Eigen::Vector3f> joints_at(const Walker& walker, float time_s) {
  const Eigen::Vector3f at = walker.from + time_s * walker.velocity;
  const Eigen::AngleAxisf turn(walker.heading_rad + time_s * walker.turn_rad_s, Eigen::Vector3f::UnitY());
  const float swing = 0.2F * std::sin(4.F * time_s) + 0.15F;
  const std::vector<Eigen::Vector3f> body = {{0.F, -0.65F, 0.F},    {0.F, -0.4F, 0.F},         {0.2F, -0.4F, 0.F},
                                             {0.25F, -0.1F, swing}, {0.3F, 0.1F, 2.F * swing}, {-0.2F, -0.4F, 0.F},
                                             {-0.25F, -0.1F, 0.F},  {-0.3F, 0.1F, -swing},     {0.F, -0.1F, 0.F},
                                             {0.1F, 0.1F, 0.F},     {0.1F, 0.5F, 0.1F},        {0.1F, 0.9F, 0.F},
                                             {-0.1F, 0.1F, 0.F},    {-0.1F, 0.5F, -swing},     {-0.1F, 0.9F, -swing}};
  std::vector<Eigen::Vector3f> joints;
  for (const Eigen::Vector3f& joint : body) joints.push_back(at + turn * joint);
  return joints;
}

/// Returns a walker as a camera would know it, `camera_from_first` away, with joints that are off by `noise_m` and
/// `behind_m` too deep.
inline TrackedPerson seen_walker(const Walker& walker, float time_s, int id, const Eigen::Isometry3f& camera_from_first,
                                 float noise_m, Random& random, float behind_m = 0.F) {
  TrackedPerson person;
  person.id = id;
  person.state = TrackState::tracked;
  std::vector<Joint>& joints = person.person.joints.emplace_back();
  for (const Eigen::Vector3f& joint : joints_at(walker, time_s)) {
    const Eigen::Vector3f off(float(random.normal()), float(random.normal()), float(random.normal()));
    joints.push_back({State::observed, camera_from_first * joint + noise_m * off, 0.9F});
    if (behind_m > 0.F) joints.back().position += behind_m * joints.back().position.normalized();
  }
  person.position = camera_from_first * (walker.from + time_s * walker.velocity);
  person.velocity = camera_from_first.linear() * walker.velocity;
  person.person.skeleton.parts.resize(paper_body().parts.size());
  return person;
}

/// Returns the pose of a camera to the side, that looks at the same people from `degrees` about the vertical 3 m before
/// the first.
inline Eigen::Isometry3f turned_about(float degrees) {
  const Eigen::Translation3f middle(0.F, 0.F, 3.F);
  return middle * Eigen::AngleAxisf(degrees * 0.0174533F, Eigen::Vector3f::UnitY()) * middle.inverse();
}

}  // namespace vesalius::test
