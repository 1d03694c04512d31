#pragma once

#include <map>
#include <string>

#include "io/recordings/mcap_writer.h"
#include "ros2/messages/message_sink.h"

namespace vesalius::ros2 {

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
