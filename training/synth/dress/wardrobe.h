#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/surface_parts.h"
#include "synth/dress/outfit.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Adds worn and carried things to a body as simple surfaces that move with its bones. Everything is fitted to the body
/// at the time when it is added, over clothes and hair that are already there.
class Wardrobe {
 public:
  Wardrobe(BodyMesh& mesh, BodyTopology& topology, SurfaceParts rules);

  /// Adds a sheet of hair behind the head, down to the neck or to the shoulder blades.
  void add_long_hair(float thickness_m, Random& random);
  /// Adds a tube around the hips and down the legs. `legs` is the share of the legs that it covers.
  void add_skirts(float legs, Fabric fabric, Random& random);
  void add_hat(Hat hat, Random& random);
  void add_backpack(Random& random);
  void add_bag(Bag bag, bool left, Random& random);
  void add_held(Held held, bool left, Random& random);

 private:
  /// How far the body extends at a height.
  struct Extent {
    float half_width = 0.F, front = 0.F, back = 0.F;
  };
  /// Returns the extent of the vertices that `bones` move, within `reach_m` of a height; zero if there are none.
  Extent extent(float y, float reach_m, std::initializer_list<Bone> bones) const;

  struct Sheet {  ///< rows of points, each row as long as the others
    std::vector<std::vector<Eigen::Vector3f>> rows;
    bool closed = false;  ///< whether each row is a ring; if rows go down, rings are counter-clockwise from above
  };
  using PartAt = std::function<std::uint8_t(const Eigen::Vector3f&)>;
  using SkinAt = std::function<SkinWeights(const Eigen::Vector3f&)>;
  void add_sheet(const Sheet& sheet, const SkinAt& skin, const PartAt& part, Fabric fabric);
  void add_box(const Eigen::Vector3f& centre, const Eigen::Matrix3f& half_axes, Bone bone);
  void add_box(const Eigen::Vector3f& centre, const Eigen::Matrix3f& half_axes, const SkinWeights& weights);
  /// Adds a rig bone that hangs from a hand at a point, and returns the weights of things that it moves.
  SkinWeights hanging(Bone hand, const Eigen::Vector3f& from);
  void add_cylinder(const Eigen::Vector3f& centre, const Eigen::Vector3f& half_axis, float radius_m,
                    const SkinWeights& weights);
  /// Adds a strap over the trunk from a bag at one hip to the other shoulder, in front and behind.
  void add_strap(bool left);
  /// Adds what stays upright in a hand whatever the arm does: umbrella, broom or cane.
  void add_upright(Held held, bool left, Random& random);

  struct Influence {
    Bone bone;
    float weight;
  };
  /// Returns the weights of at most four influences above 0.
  SkinWeights skin(std::initializer_list<Influence> influences) const;
  const BoneSegment& segment(Bone bone) const { return segments_[index(bone)]; }
  /// Returns axes as columns: along the hand, out of the palm, towards the thumb; in the body frame at rest.
  Eigen::Matrix3f hand_axes(bool left) const;

  BodyMesh& mesh_;
  BodyTopology& topology_;
  SurfaceParts rules_;
  std::array<BoneSegment, kBoneCount> segments_;
  std::array<std::uint16_t, kBoneCount> carrier_{};  ///< for each bone of the pose, the rig bone that turns like it
  std::vector<Bone> mover_;                          ///< for each vertex of the body, the bone that moves it most
};

}  // namespace vesalius::synth
