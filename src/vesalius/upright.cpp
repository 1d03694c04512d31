#include "vesalius/upright.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace vesalius {
namespace {

/// Returns where a pixel of a picture of this size comes to lie.
std::pair<int, int> turned_pixel(int u, int v, int width, int height, int quarters) {
  switch (quarters) {
    case 1:
      return {height - 1 - v, u};
    case 2:
      return {width - 1 - u, height - 1 - v};
    case 3:
      return {v, width - 1 - u};
    default:
      return {u, v};
  }
}

template <class T>
void turn(Image<T>& image, int quarters) {
  if (image.empty() || quarters == 0) return;
  const int width = image.width(), height = image.height();
  const bool lies = quarters % 2 != 0;
  Image<T> out(lies ? height : width, lies ? width : height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto [to_u, to_v] = turned_pixel(u, v, width, height, quarters);
      out(to_u, to_v) = image(u, v);
    }
  }
  image = std::move(out);
}

void turn(Eigen::Vector3f& vector, int quarters) { vector = turned(vector, quarters); }

void turn(Skeleton& skeleton, int quarters) {
  for (SkeletonPart& part : skeleton.parts) turn(part.centre, quarters);
  for (VotedPart& part : skeleton.voted) turn(part.centre, quarters);
}

void turn(std::vector<PersonPoint>& points, int quarters) {
  for (PersonPoint& point : points) turn(point.at, quarters);
}

void turn(Person& person, int quarters) {
  turn(person.skeleton, quarters);
  for (std::vector<Joint>& set : person.joints) {
    for (Joint& joint : set) turn(joint.position, quarters);
  }
  turn(person.mask, quarters);
  turn(person.labels, quarters);
  person.box = bounding_box(person.mask);
  turn(person.points, quarters);
}

/// `width` and `height` are those of the picture before it is turned.
void turn(PartCluster& cluster, int width, int height, int quarters) {
  const auto [u, v] = turned_pixel(cluster.first_pixel % width, cluster.first_pixel / width, width, height, quarters);
  cluster.first_pixel = v * (quarters % 2 != 0 ? height : width) + u;
  turn(cluster.centroid, quarters);
  Eigen::Matrix3f turning;
  for (int i = 0; i < 3; ++i) turning.col(i) = turned(Eigen::Vector3f::Unit(i), quarters);
  cluster.covariance = turning * cluster.covariance * turning.transpose();
}

void turn(Trace::Candidate& candidate, int quarters) {
  turn(candidate.rough, quarters);
  turn(candidate.grown, quarters);
  turn(candidate.labels, quarters);
  turn(candidate.points, quarters);
  turn(candidate.refined, quarters);
}

}  // namespace

int quarters_to_upright(const Frame& frame) {
  constexpr float kLeastInPicture = 0.5F;  // length of the way up in the picture's plane: 60 degrees of tilt
  constexpr float kTurned = 0.5F;          // cosine of 60 degrees
  if (frame.quarter_turns) return *frame.quarter_turns;
  if (!frame.up) return 0;
  const float right = frame.up->x(), upwards = -frame.up->y(), length = std::hypot(right, upwards);
  if (length < kLeastInPicture || upwards > kTurned * length) return 0;
  if (std::abs(right) < -upwards) return 2;
  return right < 0.F ? 1 : 3;
}

Eigen::Vector3f guessed_up(const Frame& frame) {
  return turned(-Eigen::Vector3f::UnitY(), 4 - quarters_to_upright(frame));
}

Eigen::Vector3f turned(const Eigen::Vector3f& vector, int quarters) {
  const Eigen::Vector3f& p = vector;
  switch (quarters) {
    case 1:
      return {-p.y(), p.x(), p.z()};
    case 2:
      return {-p.x(), -p.y(), p.z()};
    case 3:
      return {p.y(), -p.x(), p.z()};
    default:
      return p;
  }
}

Camera turned(const Camera& camera, int quarters) {
  const auto& [width, height, fx, fy, cx, cy] = camera;
  const float right = float(width - 1) - cx, below = float(height - 1) - cy;
  switch (quarters) {
    case 1:
      return {height, width, fy, fx, below, cx};
    case 2:
      return {width, height, fx, fy, right, below};
    case 3:
      return {height, width, fy, fx, cy, right};
    default:
      return camera;
  }
}

Frame turned(const Frame& frame, int quarters) {
  Frame out = frame;
  out.camera = turned(frame.camera, quarters);
  turn(out.depth, quarters);
  turn(out.colour, quarters);
  if (out.up) turn(*out.up, quarters);
  out.quarter_turns = 0;
  return out;
}

Mask turned(const Mask& mask, int quarters) {
  Mask out = mask;
  turn(out, quarters);
  return out;
}

Prior turned(Prior prior, int quarters) {
  for (Prior::KnownPerson& person : prior.people) {
    turn(person.mask, quarters);
    for (Capsule& capsule : person.flesh) {
      turn(capsule.from, quarters);
      turn(capsule.to, quarters);
    }
  }
  return prior;
}

PictureRegion turned(PictureRegion region, const Camera& camera, int quarters) {
  const Box& box = region.box;
  const auto corner = [&](int u, int v) { return turned_pixel(u, v, camera.width, camera.height, quarters); };
  const auto [u, v] = corner(box.u, box.v);
  const auto [other_u, other_v] = corner(box.u + box.width - 1, box.v + box.height - 1);
  region.box = {std::min(u, other_u), std::min(v, other_v), std::abs(u - other_u) + 1, std::abs(v - other_v) + 1};
  for (Plane& plane : region.planes) turn(plane.normal, quarters);
  return region;
}

Detection turned(Detection found, int quarters) {
  for (Person& person : found.people) turn(person, quarters);
  for (Plane& plane : found.planes) turn(plane.normal, quarters);
  return found;
}

Trace turned(Trace trace, int quarters) {
  const int width = trace.labels.width(), height = trace.labels.height();
  for (LabelImage* labels : {&trace.raw_labels, &trace.labels, &trace.flat, &trace.inside}) turn(*labels, quarters);
  turn(trace.clusters.index, quarters);
  for (PartCluster& cluster : trace.clusters.items) turn(cluster, width, height, quarters);
  for (Skeleton& skeleton : trace.rough) turn(skeleton, quarters);
  for (Trace::Candidate& candidate : trace.candidates) turn(candidate, quarters);
  return trace;
}

}  // namespace vesalius
