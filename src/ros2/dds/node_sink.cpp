#include "ros2/dds/node_sink.h"

#include <algorithm>

namespace vesalius::ros2 {

Publisher& NodeSink::publisher(const Topic& topic) {
  std::unique_ptr<Publisher>& known = publishers_[topic.name];
  // Reliable ones suit readers that are and readers that are not. For two seconds, what got lost can be sent again.
  constexpr int kDepth = 60;
  if (!known) known = node_.advertise(topic.name, topic.type, {.latched = topic.latched, .depth = kDepth});
  return *known;
}

bool NodeSink::wants(const Topic& topic) { return readers(topic) > 0 || topic.latched; }

void NodeSink::put(const Topic& topic, std::int64_t /*time_ns*/, std::string_view message) {
  publisher(topic).publish(message);
}

void NodeSink::wait_until_read(std::chrono::milliseconds most) const {
  const auto end = std::chrono::steady_clock::now() + most;
  for (const auto& [name, publisher] : publishers_) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    publisher->wait_until_read(std::max(left, std::chrono::milliseconds(0)));
  }
}

}  // namespace vesalius::ros2
