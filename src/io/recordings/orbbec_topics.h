#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace vesalius {

/// Recordings of Orbbec's SDK 2 and Viewer number streams: /cam/sensor_3/frameType_3 has depth, and
/// /cam/streamProfileType_3 its camera; 2 is colour, all others are infrared or no pictures.
inline constexpr int kOrbbecColour = 2, kOrbbecDepth = 3;

/// Returns the number after a prefix that a topic begins with; 0 if it does not.
inline int orbbec_number(std::string_view topic, std::string_view prefix) {
  if (!topic.starts_with(prefix)) return 0;
  int number = 0;
  std::from_chars(topic.data() + prefix.size(), topic.data() + topic.size(), number);
  return number;
}

/// Returns the number of the stream whose pictures or camera a topic has; 0 for topics of other recordings.
inline int orbbec_stream(std::string_view topic) {
  const int pictures = orbbec_number(topic, "/cam/sensor_");
  return pictures != 0 ? pictures : orbbec_number(topic, "/cam/streamProfileType_");
}

/// Returns the name of a stream's coordinate frame, which its messages do not give.
inline std::string orbbec_frame(int stream) { return "orbbec_stream_" + std::to_string(stream); }

}  // namespace vesalius
