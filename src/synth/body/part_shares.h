#pragma once

#include <Eigen/Core>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// Volume of a part that moves with one rig bone, as a share of the part's; a part's shares sum to 1.
struct PartShare {
  int part = 0;
  int bone = 0;
  float share = 0.F;                                 ///< may be negative where the part's surface folds over itself
  Eigen::Vector3f moment = Eigen::Vector3f::Zero();  ///< share times its centre at rest, metres
};
/// Returns the shares of all parts of the body's own surface, by part and bone. Flat fans close a part at its rims.
std::vector<PartShare> part_shares(const BodyMesh& mesh, int part_count);

}  // namespace vesalius::synth
