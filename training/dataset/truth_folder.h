#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/frame_truth.h"

namespace vesalius {

/// How a camera is turned over time, by groundtruth.txt of the TUM RGB-D benchmark.
class Trajectory {
 public:
  /// Reads lines of the form "timestamp tx ty tz qx qy qz qw": seconds, metres, and the rotation of the camera's
  /// optical frame in the world. Empty lines and those that begin with # are skipped. `name` is used as the path in
  /// errors. Throws Error with the line if a line has another form, its quaternion is not of unit length, or its time
  /// is not after the previous one.
  static Trajectory parse(std::string_view text, const std::string& name);
  static Trajectory read(const std::string& path);

  /// Returns the rotation from camera to world at a time, interpolated between the two nearest poses. Returns nothing
  /// outside the recording and in gaps of more than 0.15 s.
  std::optional<Eigen::Quaterniond> world_from_camera(double time_s) const;

 private:
  struct Pose {
    double time_s = 0.0;
    Eigen::Quaterniond rotation;
  };
  std::vector<Pose> poses_;  ///< by time
};

/// The truth that lies beside the pictures of a folder of frames (docs/metrics.md). `frames.csv`, in the folder or one
/// above it, has the number of people, their posture and heading; `mask/*.png` has their pixels; `joints.csv` has one
/// person's joints; `groundtruth.txt` has the camera's poses in a world whose z points up (TUM RGB-D), which tell
/// where up is.
class TruthFolder {
 public:
  /// Throws Error naming file and line of a table that cannot be used, and the folder if it has no truth at all.
  explicit TruthFolder(const std::string& folder);

  /// Returns the truth of a frame and reads its mask. Throws Error if the mask differs in size from the frame, and if
  /// nothing is known about the frame. The frames of a folder are one recording, and if they never show more than one
  /// person, the truth says that it is the same one.
  FrameTruth truth_of(const Frame& frame) const;
  /// Returns when a frame was taken: its own time or, in a folder with poses of the camera, its name if that is a
  /// number, since pictures copied out of a TUM recording are named so.
  std::optional<double> time_of(const Frame& frame) const;

 private:
  void read_people(const std::string& path, const std::string& set);
  void read_joints(const std::string& path);

  struct Facts {
    int people = -1;
    std::string posture;
    std::optional<Heading> heading;
  };
  std::string folder_;
  bool has_masks_ = false;
  bool one_person_ = false;             ///< there is somebody, and never two
  std::map<std::string, Facts> facts_;  ///< keys: names of frames
  std::optional<Trajectory> camera_;
  std::vector<std::string> joint_names_;
  std::map<std::string, std::vector<Eigen::Vector3f>> joints_;  ///< keys: names of frames
};

/// Returns the sets of a collection: the folders of frames that the frames.csv of `folder` names or that have a
/// joints.csv, in the order of their names. If `folder` itself holds frames, it is the only set.
std::vector<std::string> sets_in(const std::string& folder);

}  // namespace vesalius
