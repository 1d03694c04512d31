#pragma once

#include <Eigen/Geometry>
#include <array>
#include <utility>
#include <vector>

#include "synth/body/poser.h"
#include "synth/mesh/oriented_box.h"
#include "synth/scene/room.h"

namespace vesalius::synth {

/// Largest depth to which bodies may sink into things and into each other.
inline constexpr float kMaxSink_m = 0.03F;

/// A thick line about a bone. Lengths are in metres.
struct Capsule {
  Eigen::Vector3f from, to;
  float radius_m;
};

/// The shape by which a posed person is kept apart from things: points spread over the skin, and bones with their
/// thickness.
struct BodyOutline {
  std::vector<Eigen::Vector3f> points;
  std::array<Capsule, kBoneCount> bones;
  Eigen::AlignedBox3f bounds;
};

/// Returns the outline of a body in its own frame. It has every `stride`th vertex, of coarse bodies more.
BodyOutline outline_of(const PosedBody& body, float stature_m, std::size_t stride = 3);
BodyOutline moved(BodyOutline outline, const Eigen::Isometry3f& motion);

/// Returns whether a body sinks too far into any of the solids. The allowed depth is smaller for thin solids, so that
/// no limb passes through them.
bool sinks_in(const BodyOutline& body, const std::vector<OrientedBox>& solids);
/// Returns whether the bones of two bodies sink too far into each other.
bool sinks_in(const BodyOutline& a, const BodyOutline& b);

/// The people and furniture placed so far, in world coordinates.
class Occupancy {
 public:
  void set_eye(const Eigen::Vector3f& eye) { eyes_ = {eye}; }
  /// Sets the places at which the camera is over time; there must be one.
  void set_eyes(std::vector<Eigen::Vector3f> eyes) { eyes_ = std::move(eyes); }
  void set_room(const RoomShape& room) { room_ = room; }
  void add(const BodyOutline& body) { bodies_.push_back({body}); }
  /// Adds a person who moves, by outlines at several times.
  void add(std::vector<BodyOutline> over_time) { bodies_.push_back(std::move(over_time)); }
  void add(const std::vector<OrientedBox>& solids) { solids_.insert(solids_.end(), solids.begin(), solids.end()); }

  /// Returns whether a body or a piece of furniture can be placed, apart from everything else, the camera and the
  /// walls.
  bool free_for(const BodyOutline& body) const;
  bool free_for(const std::vector<OrientedBox>& solids) const;

  const std::vector<OrientedBox>& solids() const { return solids_; }

  /// Returns the largest share of any person's bones that these solids would hide from the camera's first place; of a
  /// person who moves, the mean over time.
  float hidden_share(const std::vector<OrientedBox>& solids) const;

 private:
  bool near_an_eye(const BodyOutline& body) const;

  std::vector<Eigen::Vector3f> eyes_ = {Eigen::Vector3f::Zero()};
  RoomShape room_{.open = true};
  std::vector<std::vector<BodyOutline>> bodies_;  ///< [person][time]
  std::vector<OrientedBox> solids_;
};

}  // namespace vesalius::synth
