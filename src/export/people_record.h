#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/camera.h"
#include "vesalius/person.h"

namespace vesalius {

/// Somebody in a line of `vesalius detect --json`: the fields of stream/person_fields.h, joints and bones, and besides
/// what the line has of joints. Numbers as floats; rounded() makes of them what the line says.
struct RecordedPerson : TrackedPerson {
  std::vector<std::vector<std::optional<Eigen::Vector2d>>> px;            ///< [set][joint]
  std::vector<std::vector<std::optional<Eigen::Quaterniond>>> rotations;  ///< [set][joint], in the set's convention
};

struct RecordedFrame {
  std::string name;
  std::string picture;  ///< name of a file that shows it; empty where nobody says so
  double time_s = 0.0;
  Camera camera;
  std::optional<FloorView> floor;
  std::vector<RecordedPerson> people;
};

/// The people of a recording.
struct PeopleRecord {
  std::vector<std::string> sets;                 ///< names of joint sets
  std::vector<std::vector<std::string>> joints;  ///< [set][joint]
  std::vector<std::string> bones;                ///< empty if nobody has a fitted body
  std::vector<RecordedFrame> frames;
  bool upright = false;            ///< whether joints and bones stand on the floor (stand_upright)
  std::vector<std::string> notes;  ///< remarks for the user

  /// Returns the index of a set. Throws UsageError naming those that there are.
  std::size_t find_set(const std::string& name) const;
};

struct RecordOptions {
  bool smoothed = false;  ///< take the smoothed joints of people who are followed
  double rate_hz = 30.0;  ///< rate of frames without times
};

/// Reads the lines of `vesalius detect --json`, with or without --track. A closing line may be missing, and a last
/// line that is cut, without its end, is left out with a note. Throws Error naming `source`, the line and what was
/// expected.
PeopleRecord parse_people(std::string_view lines, const std::string& source, const RecordOptions& options);

}  // namespace vesalius
