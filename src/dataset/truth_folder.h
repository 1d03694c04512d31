#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/sources/tum_trajectory.h"
#include "vesalius/base/frame_truth.h"

namespace vesalius {

/// What a folder of frames says about them, apart from the pictures (docs/metrics.md): `frames.csv` in it or beside it
/// with the number of people and their posture, `mask/*.png` with their pixels, `joints.csv` with one person's joints,
/// `groundtruth.txt` with the camera's poses (TUM RGB-D), from which it follows whether the camera moved.
class TruthFolder {
 public:
  /// Throws Error naming file and line for tables that cannot be used, and the folder where there is no truth at all.
  explicit TruthFolder(const std::string& folder);

  /// Reads the frame's mask. Throws Error for a mask of another size than the frame's and for a frame of which nothing
  /// is known.
  FrameTruth truth_of(const Frame& frame) const;

 private:
  void read_people(const std::string& path, const std::string& set);
  void read_joints(const std::string& path);

  struct Facts {
    int people = -1;
    std::string posture;
  };
  std::string folder_;
  bool has_masks_ = false;
  std::map<std::string, Facts> facts_;  ///< by the frame's name
  std::optional<Trajectory> camera_;
  std::vector<std::string> joint_names_;
  std::map<std::string, std::vector<Eigen::Vector3f>> joints_;  ///< likewise
};

/// Folders of frames that the frames.csv of `folder` names, or that have a joints.csv, in the order of their names;
/// only `folder` itself where it holds frames. What a collection of sets stands for.
std::vector<std::string> sets_in(const std::string& folder);

}  // namespace vesalius
