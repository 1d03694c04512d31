#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace vesalius {

/// Recordings of librealsense name topics by streams: "/device_0/sensor_1/Color_0/image/data".

/// Returns the stream of a topic, "/device_0/sensor_1/Color_0"; empty for topics of other recordings. It is the
/// stream's coordinate frame, since the messages' own frames are all the same up to librealsense 2.55.
inline std::string realsense_stream(std::string_view topic) {
  constexpr int kParts = 3;
  if (!topic.starts_with("/device_") || topic.find("/sensor_") == topic.npos) return {};
  std::size_t end = 0;
  for (int part = 0; part < kParts; ++part) {
    end = topic.find('/', end + 1);
    if (end == topic.npos) return {};
  }
  return std::string(topic.substr(0, end));
}

/// ROS 1 had names of coordinate frames with a slash before them.
inline std::string plain_frame(std::string_view frame) {
  return std::string(frame.starts_with('/') && !frame.starts_with("/device_") ? frame.substr(1) : frame);
}

/// Returns the value of `key` in "width=640;height=480"; empty if there is none.
inline std::string_view realsense_value(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view field = text.substr(0, text.find(';'));
    if (field.size() > key.size() && field.starts_with(key) && field[key.size()] == '=') {
      return field.substr(key.size() + 1);
    }
    text.remove_prefix(std::min(text.size(), field.size() + 1));
  }
  return {};
}

/// Returns the numbers of "0.1,0.2"; as many as can be read.
inline std::vector<double> realsense_numbers(std::string_view text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* end = at + text.size();
  for (double number = 0.0; at < end; ++at) {
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc()) break;
    numbers.push_back(number);
    at = stop;
  }
  return numbers;
}

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
