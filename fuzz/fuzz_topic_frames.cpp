#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ros2/messages/topic_frames.h"
#include "vesalius/error.h"

namespace {

/// What a message costs: a byte that says of which topic it is, and two of its length.
constexpr std::size_t kHead = 3;

void take(vesalius::ros2::TopicFrames& frames, unsigned topic, std::string_view message) {
  try {
    if (topic % 3 == 0) frames.take_calibration(message);
    if (topic % 3 == 1) frames.take_depth(message, 0.0);
    if (topic % 3 == 2) frames.take_colour(message);
    frames.next(1.0);
  } catch (const vesalius::Error&) {
  }
  frames.take_notes();
}

}  // namespace

/// Messages of a camera's topics, one after the other.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view left(reinterpret_cast<const char*>(data), size);
  const bool compressed = size > 0 && data[0] >= 128;
  vesalius::ros2::TopicFrames frames(
      compressed ? vesalius::ros2::CameraTopics{"/c/depth/compressedDepth", "/c/camera_info", "/c/rgb/compressed"}
                 : vesalius::ros2::CameraTopics{"/c/depth", "/c/camera_info", "/c/rgb"});
  while (left.size() > kHead) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(left[i])); };
    const unsigned topic = byte(0);
    const std::size_t length = byte(1) | byte(2) << 8U;
    left.remove_prefix(kHead);
    take(frames, topic, left.substr(0, length));
    left.remove_prefix(std::min(length, left.size()));
  }
  return 0;
}
