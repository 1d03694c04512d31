#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "synth/body/poser.h"
#include "synth/scene/oriented_box.h"
#include "synth/scene/room.h"

namespace vesalius::synth {

/// How far bodies may sink into things and into each other.
inline constexpr float kMaxSink_m = 0.03F;

/// Thick line about a bone. Metres.
struct Capsule {
  Eigen::Vector3f from, to;
  float radius_m;
};

/// What keeps a posed person apart from things: points spread over the skin, and the bones with flesh.
struct BodyOutline {
  std::vector<Eigen::Vector3f> points;
  std::array<Capsule, kBoneCount> bones;
  Eigen::AlignedBox3f bounds;
};

/// Of a body in its own frame; one vertex in three.
BodyOutline outline_of(const PosedBody& body, float stature_m);
BodyOutline moved(BodyOutline outline, const Eigen::Isometry3f& motion);

/// Returns whether a body sinks into any of the solids too far; thin ones let it in less deep, so that no limb goes
/// through.
bool sinks_in(const BodyOutline& body, const std::vector<OrientedBox>& solids);
/// Returns whether two bodies' bones sink into each other too far.
bool sinks_in(const BodyOutline& a, const BodyOutline& b);

/// Who and what stands where, in world coordinates.
class Occupancy {
 public:
  void set_eye(const Eigen::Vector3f& eye) { eye_ = eye; }
  void set_room(const RoomShape& room) { room_ = room; }
  void add(const BodyOutline& body) { bodies_.push_back(body); }
  void add(const std::vector<OrientedBox>& solids) { solids_.insert(solids_.end(), solids.begin(), solids.end()); }

  /// Returns whether a body or piece of furniture can be put there: apart from all others, from the camera and from the
  /// walls.
  bool free_for(const BodyOutline& body) const;
  bool free_for(const std::vector<OrientedBox>& solids) const;

  const std::vector<OrientedBox>& solids() const { return solids_; }

  /// Largest share of any one person's bones that these solids would hide from the camera.
  float hidden_share(const std::vector<OrientedBox>& solids) const;

 private:
  Eigen::Vector3f eye_ = Eigen::Vector3f::Zero();
  RoomShape room_{.open = true};
  std::vector<BodyOutline> bodies_;
  std::vector<OrientedBox> solids_;
};

}  // namespace vesalius::synth
