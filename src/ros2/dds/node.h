#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ros2/messages/discovery_message.h"
#include "ros2/messages/names.h"

namespace vesalius::ros2 {

struct NodeOptions {
  std::string name = "vesalius";
  std::string name_space = "/";
  int domain = 0;                     ///< 0 to kMostDomain
  bool localhost = false;             ///< speak to this machine alone
  std::size_t gid_bytes = kGidBytes;  ///< or kOldGidBytes, for peers up to Humble
  /// Gets what the network complains of, a line each, from any thread; may be empty.
  std::function<void(const std::string&)> say = {};
};
inline constexpr int kMostDomain = 232;

/// How messages of a topic are handed over.
struct Qos {
  bool reliable = true;  ///< a reader hears only writers that are; a writer serves readers of either kind
  bool latched = false;  ///< whoever comes late gets the last message ("transient local")
  int depth = 10;        ///< messages that are kept for whoever is slow, or to be sent again
};

class Participant;

/// Writes messages of one topic, until it is destroyed.
class Publisher {
 public:
  Publisher(std::shared_ptr<Participant> participant, std::int32_t writer);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Sends a message that is CDR. Does not wait for readers: where those that lag hold 1 GB, it is dropped. Throws
  /// Error if the network refuses it.
  void publish(std::string_view message);
  /// Returns how many readers there are.
  int readers() const;
  /// Waits until all readers have all messages, for at most so long. Returns whether they have.
  bool wait_until_read(std::chrono::milliseconds most) const;

 private:
  std::shared_ptr<Participant> participant_;
  std::int32_t writer_;
};

/// Reads messages of one topic, until it is destroyed.
class Subscription {
 public:
  Subscription(std::shared_ptr<Participant> participant, std::int32_t reader);
  ~Subscription();
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

  /// Returns the next message as CDR, at most three zeros longer than it was sent; nothing if none has come.
  std::optional<std::string> take();

 private:
  std::shared_ptr<Participant> participant_;
  std::int32_t reader_;
};

/// A node of ROS 2 in a process of its own, by Cyclone DDS: topics and types under their names on the wire, and itself
/// with all that it reads and writes in `ros_discovery_info`, so that `ros2 node list` and `info` know it. It has
/// neither services nor parameters. Publishers and subscriptions may outlive it. All may be
/// used from several threads.
class Node {
 public:
  /// Throws UsageError for options outside their range, Error if there is no network.
  explicit Node(const NodeOptions& options);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// `topic` is a full name (check_full_name), `type` e.g. "sensor_msgs/Image". Throws Error.
  std::unique_ptr<Publisher> advertise(const std::string& topic, const std::string& type, const Qos& qos);
  std::unique_ptr<Subscription> subscribe(const std::string& topic, const std::string& type, const Qos& qos);

  /// Waits until a subscription has a message, for at most so long. Returns whether one has.
  bool wait(std::chrono::milliseconds most);

  /// Returns what others publish now, by name.
  std::vector<TopicType> published();

  const NodeOptions& options() const { return options_; }

 private:
  NodeOptions options_;
  std::shared_ptr<Participant> participant_;
};

}  // namespace vesalius::ros2
