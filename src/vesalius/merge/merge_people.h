#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "vesalius/person.h"

namespace vesalius {

/// What one of several cameras tells of a moment.
struct CameraPeople {
  TrackedFrame people;    ///< of its frame nearest to the moment, in its own optical frame
  double behind_s = 0.0;  ///< how much earlier that frame was taken than the moment; below 0 later
};

/// Makes one list of the people whom several cameras follow, each by itself. Somebody whom one camera loses behind
/// something, or who turns up there under a new id, stays the same person as long as another camera goes on seeing
/// them. Everything is in the optical frame of the first camera.
class PeopleMerger {
 public:
  /// `first_from` has the pose of each camera, of the first the identity.
  explicit PeopleMerger(std::vector<Eigen::Isometry3f> first_from);
  ~PeopleMerger();
  PeopleMerger(PeopleMerger&&) noexcept;
  PeopleMerger& operator=(PeopleMerger&&) noexcept;

  /// Takes what each camera tells of the next moment, which is the first's frame. Returns its people: joints and parts
  /// as fuse_person makes them, TrackedPerson::seen_by, ids of this list alone, a mask where the first camera sees the
  /// person; stance and fitted body of the camera that sees the person best. Who is a guess to all cameras is left
  /// out. The floor is the first's, or else that of another. Reasons of what is not observed
  /// are those of one camera alone: explain_unseen gives them anew. Throws Error for another number of cameras.
  TrackedFrame merge(std::vector<CameraPeople> seen);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius
