#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius {

/// Puts one OSC 1.0 message together.
class OscMessage {
 public:
  explicit OscMessage(std::string_view address);
  OscMessage& add(std::int32_t value);
  OscMessage& add(float value);
  OscMessage& add(std::string_view text);
  /// Returns the message's bytes.
  std::string bytes() const;

 private:
  std::string address_, types_ = ",", values_;
};

/// What is sent of each joint.
struct OscOptions {
  std::string joints = "k4abt32";  ///< joint set
  bool on_floor = true;            ///< whether places are the floor's where it is known, or always the camera's
};

/// Returns the people of a frame as OSC bundles that fit into Ethernet's packets. Metres, x right, y up, z towards the
/// camera; the origin lies on the floor below it where that is known and wanted, else in the camera:
///   /vesalius/people        how many, then their ids
///   /vesalius/ID/state      tracked, hidden ...; seen where nobody follows people
///   /vesalius/ID/position   x y z: the middle of the trunk, of people who are followed
///   /vesalius/ID/JOINT      x y z confidence: of every joint that has a place
/// The id is that of the track, or the index in the frame where nobody follows people. Throws UsageError if the body
/// has no such joint set.
std::vector<std::string> osc_bundles(const TrackedFrame& people, const BodyModel& body, const OscOptions& options);

}  // namespace vesalius
