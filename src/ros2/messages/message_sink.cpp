#include "ros2/messages/message_sink.h"

#include "io/recordings/people_messages.h"
#include "ros2/messages/names.h"

namespace vesalius::ros2 {

void RecordSink::put(const Topic& topic, std::int64_t time_ns, std::string_view message) {
  auto known = topics_.find(topic.name);
  if (known == topics_.end()) {
    const std::uint16_t number = out_.add_topic(topic.name, long_type(topic.type), message_definition(topic.type));
    known = topics_.emplace(topic.name, number).first;
  }
  out_.write(known->second, time_ns, message);
  if (other_.wants(topic)) other_.put(topic, time_ns, message);
}

}  // namespace vesalius::ros2
