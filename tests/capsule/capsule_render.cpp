#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "capsule/capsule_person.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A solid with its person and the pixels that it may cover.
struct Actor {
  BodySolid solid;
  std::uint8_t person;
  int u_low, u_high, v_low, v_high;  ///< inclusive
};

/// The first surface that a ray meets.
struct Surface {
  double t = std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::Zero();
  Vector3d texture = Vector3d::Zero();  ///< point on the surface, in texture cells, in a frame that moves with it
  Rgb colour;
  std::uint8_t label = kBackground;
  std::uint8_t person = kBackground;
};

/// Returns the first and last pixel that a sphere may cover along one axis, or all pixels if it extends behind the
/// camera.
std::pair<int, int> covered(double x, double z, double r, double focal, double centre, int size) {
  const double near_z = z - r;
  if (near_z < 1e-3) return {0, size - 1};
  const double low = std::min((x - r) / near_z, (x - r) / (z + r));
  const double high = std::max((x + r) / near_z, (x + r) / (z + r));
  const auto pixel = [&](double ratio) { return std::clamp(ratio * focal + centre, -1.0, static_cast<double>(size)); };
  return {std::max(0, static_cast<int>(std::floor(pixel(low)))),
          std::min(size - 1, static_cast<int>(std::ceil(pixel(high))))};
}

Actor make_actor(const BodySolid& solid, std::size_t person, const Matrix3d& camera_from_world, const Camera& camera) {
  Actor actor{solid, static_cast<std::uint8_t>(person), camera.width, -1, camera.height, -1};
  const double r = solid.shape.scale_m.maxCoeff();
  for (const double end : {-solid.shape.half_length, solid.shape.half_length}) {
    const Vector3d c = camera_from_world * solid.shape.world({0.0, end, 0.0});
    const auto [u_low, u_high] = covered(c.x(), c.z(), r, camera.fx, camera.cx, camera.width);
    const auto [v_low, v_high] = covered(c.y(), c.z(), r, camera.fy, camera.cy, camera.height);
    actor.u_low = std::min(actor.u_low, u_low);
    actor.u_high = std::max(actor.u_high, u_high);
    actor.v_low = std::min(actor.v_low, v_low);
    actor.v_high = std::max(actor.v_high, v_high);
  }
  return actor;
}

/// Texture cells per metre: fine ones on people, coarse ones on furniture and walls.
constexpr double kFineCells = 25.0, kCoarseCells = 3.0;

/// Meets a wall or floor, which is the plane where coordinate `axis` is `at`.
void meet_plane(const Vector3d& ray, int axis, double at, Rgb colour, Surface& first) {
  const double t = at / ray[axis];
  if (!(t > 0.0 && t < first.t)) return;
  first = Surface{
      t, Vector3d::Unit(axis) * (at > 0.0 ? -1.0 : 1.0), t * kCoarseCells * ray, colour, kBackground, kBackground};
}

void meet_box(const Vector3d& ray, const SceneBox& box, Surface& first) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  int side = -1;
  for (int axis = 0; axis < 3; ++axis) {
    double t1 = box.low[axis] / ray[axis], t2 = box.high[axis] / ray[axis];
    if (ray[axis] == 0.0) {  // avoids 0/0
      const bool between = box.low[axis] <= 0.F && box.high[axis] >= 0.F;
      t1 = between ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
      t2 = std::numeric_limits<double>::infinity();
    }
    if (t1 > t2) std::swap(t1, t2);
    if (t1 > enter) side = axis;
    enter = std::max(enter, t1);
    leave = std::min(leave, t2);
  }
  if (side < 0 || enter > leave || enter >= first.t) return;
  const Vector3d outward = Vector3d::Unit(side) * (ray[side] > 0.0 ? -1.0 : 1.0);
  first = Surface{enter, outward, enter * kCoarseCells * ray, box.colour, kBackground, kBackground};
}

void meet_actor(const Vector3d& ray, const Actor& actor, const std::vector<std::uint8_t>& label_of, Surface& first) {
  const auto hit = intersect(actor.solid.shape, Vector3d::Zero(), ray);
  if (!hit || hit->t >= first.t) return;
  const bool crown = hit->local.y() - 0.8 * hit->local.z() > 0.45;  // the top and back
  first = Surface{hit->t,
                  normal(actor.solid.shape, hit->local),
                  kFineCells * hit->local.cwiseProduct(actor.solid.shape.scale_m),
                  crown ? actor.solid.crown : actor.solid.colour,
                  label_of[actor.solid.part_at(hit->local)],
                  actor.person};
}

/// Returns 0.9 to 1.1, the same within each cell of a surface. It is a brightness, which leaves the hue unchanged.
double texture(const Vector3d& at) {
  std::uint32_t hash = 2166136261U;
  for (int axis = 0; axis < 3; ++axis) {
    hash = (hash ^ static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(at[axis])))) * 16777619U;
  }
  hash ^= hash >> 15U;
  return 0.9 + 0.2 * ((hash * 2246822519U) >> 24U) / 255.0;
}

/// Shades a surface by Lambert's law under a lamp above and behind the camera.
Rgb shade(const Surface& surface) {
  const Vector3d to_lamp = Vector3d(0.0, -0.5, -0.85).normalized();
  const double light = (0.45 + 0.55 * std::max(0.0, surface.normal.dot(to_lamp))) * texture(surface.texture);
  const auto lit = [&](std::uint8_t c) { return static_cast<std::uint8_t>(std::min(255.0, c * light)); };
  return {lit(surface.colour.r), lit(surface.colour.g), lit(surface.colour.b)};
}

Surface first_surface(const Vector3d& ray, const CapsuleScene& scene) {
  Surface first;
  if (scene.floor_y_m > 0.F) meet_plane(ray, 1, scene.floor_y_m, scene.floor_colour, first);
  if (scene.wall_z_m > 0.F) meet_plane(ray, 2, scene.wall_z_m, scene.wall_colour, first);
  if (scene.side_wall_x_m > 0.F) {
    meet_plane(ray, 0, scene.side_wall_x_m, scene.wall_colour, first);
    meet_plane(ray, 0, -scene.side_wall_x_m, scene.wall_colour, first);
  }
  for (const SceneBox& box : scene.boxes) meet_box(ray, box, first);
  return first;
}

/// Returns the label in `body` of each of the paper's parts.
std::vector<std::uint8_t> match_parts(const BodyModel& body) {
  const BodyModel& paper = paper_body();
  std::vector<int> parent(paper.parts.size(), -1);
  for (const BodyLink& link : paper.links) parent[link.child] = link.parent;
  std::vector<std::uint8_t> label_of;
  for (int p = 0; p < paper.part_count(); ++p) {
    int up = p, found = -1;
    for (; up >= 0 && found < 0; up = parent[up]) {
      found = body.find_part(paper.parts[up].name);
    }
    label_of.push_back(found >= 0 ? static_cast<std::uint8_t>(found) : kBackground);
  }
  return label_of;
}

/// Returns for each part of `body` the mean of the centres of the paper's parts for which it stands; NaN if there is
/// none.
std::vector<Eigen::Vector3f> centres_in(const std::vector<BodySolid>& solids, const Matrix3d& camera_from_world,
                                        const std::vector<std::uint8_t>& label_of, const BodyModel& body) {
  std::vector<Vector3d> sum(body.parts.size(), Vector3d::Zero());
  std::vector<int> count(body.parts.size(), 0);
  const std::vector<Vector3d> centres = part_centres(solids);
  for (std::size_t p = 0; p < centres.size(); ++p) {
    if (label_of[p] == kBackground) continue;
    sum[label_of[p]] += camera_from_world * centres[p];
    ++count[label_of[p]];
  }
  std::vector<Eigen::Vector3f> result;
  for (std::size_t p = 0; p < sum.size(); ++p) {
    const Vector3d mean =
        count[p] > 0 ? Vector3d(sum[p] / count[p]) : Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    result.emplace_back(mean.cast<float>());
  }
  return result;
}

void check(const CapsuleScene& scene) {
  if (scene.people.size() > kBackground) {
    throw Error("capsule scene: " + std::to_string(scene.people.size()) + " people, at most 255");
  }
  for (const float value : {scene.floor_y_m, scene.wall_z_m, scene.side_wall_x_m, scene.pitch}) {
    if (!std::isfinite(value)) throw Error("capsule scene: floor, walls and pitch must be finite");
  }
  for (std::size_t b = 0; b < scene.boxes.size(); ++b) {
    const SceneBox& box = scene.boxes[b];
    if (!box.low.allFinite() || !box.high.allFinite() || (box.low.array() > box.high.array()).any()) {
      throw Error("capsule scene: box " + std::to_string(b) + " must be finite with low <= high");
    }
  }
}

void write_pixel(const Surface& surface, int u, int v, LabelledFrame& out) {
  const double depth_mm = surface.t * 1000.0 + 0.5;
  // The surface is too far for 16 bits, or there is none.
  if (!(depth_mm < 65536.0) || depth_mm < 1.0) return;
  out.frame.depth(u, v) = static_cast<std::uint16_t>(depth_mm);
  out.frame.colour(u, v) = shade(surface);
  out.labels(u, v) = surface.label;
  out.person(u, v) = surface.person;
}

}  // namespace

LabelledFrame render(const CapsuleScene& scene, const Camera& camera, const BodyModel& body) {
  check(camera);
  check(scene);
  const Matrix3d world_from_camera =
      Eigen::AngleAxisd(-static_cast<double>(scene.pitch), Vector3d::UnitX()).toRotationMatrix();
  const Matrix3d camera_from_world = world_from_camera.transpose();
  const std::vector<std::uint8_t> label_of = match_parts(body);

  LabelledFrame out;
  out.frame.camera = camera;
  out.frame.depth = DepthImage(camera.width, camera.height);
  out.frame.colour = ColourImage(camera.width, camera.height);
  out.labels = LabelImage(camera.width, camera.height, kBackground);
  out.person = Image<std::uint8_t>(camera.width, camera.height, kBackground);
  std::vector<Actor> actors;
  for (std::size_t p = 0; p < scene.people.size(); ++p) {
    const std::vector<BodySolid> solids = make_solids(scene.people[p]);
    for (const BodySolid& solid : solids) actors.push_back(make_actor(solid, p, camera_from_world, camera));
    out.parts.push_back(centres_in(solids, camera_from_world, label_of, body));
  }

  parallel_for(camera.height, [&](int v) {
    std::vector<const Actor*> in_row;
    for (const Actor& actor : actors) {
      if (v >= actor.v_low && v <= actor.v_high) in_row.push_back(&actor);
    }
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d ray = world_from_camera * Vector3d((u - static_cast<double>(camera.cx)) / camera.fx,
                                                        (v - static_cast<double>(camera.cy)) / camera.fy, 1.0);
      Surface first = first_surface(ray, scene);
      for (const Actor* actor : in_row) {
        if (u >= actor->u_low && u <= actor->u_high) meet_actor(ray, *actor, label_of, first);
      }
      write_pixel(first, u, v, out);
    }
  });
  return out;
}

}  // namespace vesalius
