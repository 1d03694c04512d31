#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>

#include "ros2/dds/node.h"
#include "ros2/messages/message_sink.h"

namespace vesalius::ros2 {

/// Publishes messages. Topics without readers want none, but for those that are latched.
class NodeSink final : public MessageSink {
 public:
  /// `node` must outlive this object.
  explicit NodeSink(Node& node) : node_(node) {}

  bool wants(const Topic& topic) override;
  void put(const Topic& topic, std::int64_t time_ns, std::string_view message) override;
  void end(const std::string& topic) override { publishers_.erase(topic); }
  /// Returns how many readers a topic has.
  int readers(const Topic& topic) { return publisher(topic).readers(); }
  /// Waits until all readers have all messages, for at most so long altogether.
  void wait_until_read(std::chrono::milliseconds most) const;

 private:
  Publisher& publisher(const Topic& topic);

  Node& node_;
  std::map<std::string, std::unique_ptr<Publisher>> publishers_;
};

}  // namespace vesalius::ros2
