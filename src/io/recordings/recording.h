#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// How the fields of messages are laid out.
enum class MessageLayout {
  ros1,      ///< little-endian, without gaps
  cdr,       ///< ROS 2: aligned, in either byte order, after four bytes that say which
  protobuf,  ///< Protocol Buffers
  json,      ///< a JSON object each
  other      ///< none that is read here
};

/// A stream of messages of one type in a recording.
struct RecordedTopic {
  std::string name;  ///< e.g. "/camera/depth/image_raw"
  std::string type;  ///< without the folder that ROS 2 puts in the middle, e.g. "sensor_msgs/Image"
  MessageLayout layout = MessageLayout::other;
  /// Number of messages; -1 where it is known only after they were read.
  std::int64_t messages = -1;
};

/// Returns whether the fields of its messages are laid out as in ROS 1 or 2.
inline bool is_ros(const RecordedTopic& topic) {
  return topic.layout == MessageLayout::ros1 || topic.layout == MessageLayout::cdr;
}

/// Nanoseconds of a second.
inline constexpr std::int64_t kNanoseconds = 1'000'000'000;

/// Returns how far two times lie apart. Those of damaged files may be any number, whose difference no signed one holds.
inline std::uint64_t apart_ns(std::int64_t a, std::int64_t b) {
  const auto wrapped = static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b);
  return a > b ? wrapped : std::uint64_t{0} - wrapped;
}

/// Returns the name of a frame of that time: seconds with nine places.
std::string name_of_time(std::int64_t time_ns);

struct RecordedMessage {
  std::size_t topic = 0;     ///< index in Recording::topics()
  std::int64_t time_ns = 0;  ///< when it was recorded
  std::string_view bytes;    ///< valid up to the next call of `next`
};

/// A file of messages, in the order in which they were recorded.
class Recording {
 public:
  virtual ~Recording() = default;
  virtual const std::vector<RecordedTopic>& topics() const = 0;
  /// Returns the next message, nothing at the end. Throws Error naming the file where it is damaged; the call after
  /// that returns nothing.
  virtual std::optional<RecordedMessage> next() = 0;
  /// Starts again with the first message.
  virtual void rewind() = 0;
  /// Returns when the latest message was recorded; nothing where there are none.
  virtual std::optional<std::int64_t> last_ns() const = 0;
  /// Goes on with a message from which on all come that were recorded at `time_ns` or later; earlier ones may come
  /// among them. Parts of the file that end before are not read. Returns whether it left out any.
  virtual bool seek(std::int64_t time_ns) = 0;
  /// Returns what is not as it should be, a line each: a file cut short, of which the whole messages are read.
  virtual std::vector<std::string> notes() const { return {}; }
};

/// Removes the middle of a type's name in ROS 2: "sensor_msgs/msg/Image" becomes "sensor_msgs/Image".
std::string short_type(std::string_view type);

}  // namespace vesalius
