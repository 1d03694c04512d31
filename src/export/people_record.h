#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/camera.h"

namespace vesalius {

/// A joint or nothing, as a line of `vesalius detect --json` has it (docs/formats.md).
struct RecordedJoint {
  std::optional<Eigen::Vector3d> at_m;  ///< optical frame
  std::optional<Eigen::Vector2d> px;
  double confidence = 0.0;
  std::string state = "none";  ///< observed, predicted or none
};

/// A bone of a fitted body (docs/tracking.md).
struct RecordedBone {
  Eigen::Vector3d head_m = Eigen::Vector3d::Zero(), tail_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond global = Eigen::Quaterniond::Identity();  ///< from the bone's frame at rest to the optical frame
};

struct RecordedPerson {
  int id = 0;  ///< that of the track, or the index in a single frame
  double score = 0.0;
  std::array<double, 4> box_px{};                  ///< column, row, width, height; all 0 where the person is not found
  std::vector<std::vector<RecordedJoint>> joints;  ///< [set][joint]
  std::vector<std::vector<std::optional<Eigen::Quaterniond>>> rotations;  ///< [set][joint], in the set's convention
  std::vector<RecordedBone> bones;                                        ///< [bone]; empty without a fitted body
};

struct RecordedFrame {
  std::string name;
  double time_s = 0.0;
  Camera camera;
  std::vector<RecordedPerson> people;
};

/// The people of a recording.
struct PeopleRecord {
  std::vector<std::string> sets;                 ///< names of joint sets
  std::vector<std::vector<std::string>> joints;  ///< [set][joint]
  std::vector<std::string> bones;                ///< empty if nobody has a fitted body
  std::vector<RecordedFrame> frames;
  bool followed = false;  ///< whether ids hold over frames

  /// Returns the index of a set. Throws UsageError naming those that there are.
  std::size_t find_set(const std::string& name) const;
};

struct RecordOptions {
  bool smoothed = false;  ///< take the smoothed joints of people who are followed
  double rate_hz = 30.0;  ///< of frames without times
};

/// Reads the lines of `vesalius detect --json`, with or without --track. A closing line may be missing. Throws Error
/// naming `source`, the line and what was expected.
PeopleRecord parse_people(std::string_view lines, const std::string& source, const RecordOptions& options);

}  // namespace vesalius
