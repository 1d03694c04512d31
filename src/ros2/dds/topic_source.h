#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ros2/dds/node.h"
#include "ros2/messages/topic_frames.h"
#include "vesalius/frame_source.h"

namespace vesalius::ros2 {

struct TopicSourceOptions {
  std::string
      name_space;         ///< a camera's, e.g. "/camera", below which topics are chosen; may be empty if depth is named
  CameraTopics topics;    ///< those that the user names, full names; empty ones are chosen
  SourceOptions stored;   ///< how depth is stored; the rest counts nothing
  bool reliable = false;  ///< ask again for pictures that get lost, with publishers that can do that
  /// Gets a line when topics are found, when nothing comes, and when a message is not what it should be, in the thread
  /// that calls `next`.
  std::function<void(const std::string&)> say;
};

/// Frames from the topics of a camera's driver, as they come (TopicFrames). It waits for the topics, and for pictures,
/// as long as it takes: publishers come and go. What is wrong with messages it says
/// once, and ten such lines at most.
class TopicSource final : public FrameSource {
 public:
  /// `node` must outlive this object.
  TopicSource(Node& node, TopicSourceOptions options);

  std::optional<Frame> next() override;
  int size() const override { return -1; }
  bool is_live() const override { return true; }
  void stop() override { stopped_ = true; }

  /// Returns when and where one of the last frames was taken. May be called from another thread.
  Stamp stamp_of(const Frame& frame) const;

 private:
  void find_topics();
  void open(const CameraTopics& topics);
  void take_messages();
  void complain(const std::string& line);
  void say_if_silent();

  Node& node_;
  TopicSourceOptions options_;
  std::optional<CameraTopics> topics_;
  std::optional<TopicFrames> frames_;
  std::unique_ptr<Subscription> depth_, camera_info_, colour_;
  std::atomic<bool> stopped_ = false;
  std::set<std::string> complaints_;
  double found_s_ = 0.0;  ///< when depth was found; 0 = not yet
  double last_s_;         ///< when a frame came, or the waiting began
  bool said_silent_ = false;
  mutable std::mutex mutex_;                          ///< guards the stamps
  std::deque<std::pair<std::string, Stamp>> stamps_;  ///< stamps of the last frames, by name
};

}  // namespace vesalius::ros2
