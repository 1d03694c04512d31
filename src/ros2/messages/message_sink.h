#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "io/recordings/mcap_writer.h"

namespace vesalius::ros2 {

/// A topic that messages are written to.
struct Topic {
  std::string name;      ///< full, e.g. "/vesalius/body_index"
  std::string type;      ///< e.g. "sensor_msgs/Image"
  bool latched = false;  ///< whoever comes late gets the last message
};

/// Takes messages of topics, which begin when they are first mentioned.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  /// Returns whether a message of the topic would get to anybody now. Those that would not need not be made.
  virtual bool wants(const Topic& topic) = 0;
  /// Takes a message as CDR. Throws Error if it cannot.
  virtual void put(const Topic& topic, std::int64_t time_ns, std::string_view message) = 0;
  /// Ends a topic.
  virtual void end(const std::string& topic) = 0;
};

/// Writes all messages to an MCAP file, and passes on those that another sink wants.
class RecordSink final : public MessageSink {
 public:
  /// Creates the file. Throws Error as McapWriter does. `other` must outlive this object.
  RecordSink(const std::string& path, MessageSink& other) : out_(path), other_(other) {}

  bool wants(const Topic&) override { return true; }
  void put(const Topic& topic, std::int64_t time_ns, std::string_view message) override;
  void end(const std::string& topic) override { other_.end(topic); }
  /// Completes the file.
  void close() { out_.close(); }

 private:
  McapWriter out_;
  MessageSink& other_;
  std::map<std::string, std::uint16_t> topics_;
};

}  // namespace vesalius::ros2
