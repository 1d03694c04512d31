#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/recordings/recording.h"

namespace vesalius {

/// A message of one of Foxglove's schemas, by the names of its fields; a field that the message lacks is 0 or empty.
class FoxgloveMessage {
 public:
  struct Value {
    std::uint64_t number = 0;                  ///< times are nanoseconds
    std::string_view text;                     ///< into the message, or into `owned`
    std::shared_ptr<const std::string> owned;  ///< what the message has in another encoding
    std::vector<double> reals;
  };

  std::uint64_t number(std::string_view field) const { return (*this)[field].number; }
  std::string_view text(std::string_view field) const { return (*this)[field].text; }
  const std::vector<double>& reals(std::string_view field) const { return (*this)[field].reals; }
  const Value& operator[](std::string_view field) const;

 private:
  friend class FoxgloveReader;
  std::map<std::string_view, Value> values_;
};

/// Returns whether messages are of a schema, e.g. "RawImage": in Protocol Buffers or JSON, or of foxglove_msgs in ROS.
bool is_foxglove(const RecordedTopic& topic, std::string_view schema);

/// Reads a message of a topic that is_foxglove of RawImage, CompressedImage, CompressedVideo, CameraCalibration or
/// FrameTransform; all transforms of FrameTransforms. Throws Error naming `name`.
std::vector<FoxgloveMessage> read_foxglove(const RecordedTopic& topic, std::string_view message,
                                           const std::string& name);

}  // namespace vesalius
