#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "export/people_record.h"

namespace vesalius {

/// A person's fitted body as animation programs take it: bones of one length each that turn about their heads, y up,
/// the origin that of the record. Lengths are medians over all frames with a body.
struct MovingSkeleton {
  struct Bone {
    std::string name;  ///< as Mixamo calls it
    int flesh = -1;    ///< index in builtin_flesh()
    int parent = -1;   ///< parents come first
    Eigen::Vector3d offset_m =
        Eigen::Vector3d::Zero();                       ///< from the parent's head, in the parent's frame; of the root 0
    Eigen::Vector3d tail_m = Eigen::Vector3d::Zero();  ///< from the head, in the bone's frame
    bool ends = true;                                  ///< whether no other bone hangs on it
  };
  struct Pose {
    double time_s = 0.0;
    bool there = true;  ///< whether the frame has a body; where it has none, all else is that of the frame before
    Eigen::Vector3d root_m = Eigen::Vector3d::Zero();
    std::vector<Eigen::Quaterniond> local;  ///< [bone]: from the parent's frame
    /// [bone]: where its head is in this frame's body, as Bone::offset_m. Bodies are fitted ever better, so they
    /// change.
    std::vector<Eigen::Vector3d> offsets_m;
    std::vector<float> shape;  ///< coefficients of builtin_flesh()'s shapes; empty where the record has none
  };

  int id = 0;
  std::vector<Bone> bones;
  std::vector<Pose> poses;   ///< one for each frame from the person's first body to the last
  std::vector<float> shape;  ///< medians over all frames; empty where the record does not have everyone's
};

/// Returns the skeletons of all people with a fitted body, or of one. Throws Error if there is none, which says that
/// bodies come with --track.
std::vector<MovingSkeleton> moving_skeletons(const PeopleRecord& record, std::optional<int> person);

/// Returns a rotation's angles in degrees about z, x and y: it is that about z times that about x times that about y.
Eigen::Vector3d zxy_degrees(const Eigen::Quaterniond& rotation);

}  // namespace vesalius
