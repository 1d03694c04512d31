#pragma once

#include <Eigen/Core>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// The share of a part's volume that moves with one rig bone. The shares of a part sum to 1.
struct PartShare {
  int part = 0;
  int bone = 0;
  float share = 0.F;                                 ///< may be negative if the part's surface folds over itself
  Eigen::Vector3f moment = Eigen::Vector3f::Zero();  ///< share multiplied by its centre at rest, metres
};
/// Returns the shares of all parts of the body's own surface, by part and bone. A part's surface is closed at its rims
/// by flat fans.
std::vector<PartShare> part_shares(const BodyMesh& mesh, int part_count);

}  // namespace vesalius::synth
