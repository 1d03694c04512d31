#include "ros2/dds/topic_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "io/sensors/live_source.h"
#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

constexpr std::chrono::milliseconds kBetweenQuestions(50);
constexpr double kSilence_s = 5.0;
/// So long after depth its colour may show itself.
constexpr double kForColour_s = 1.0;
constexpr std::size_t kMostComplaints = 10;
/// More frames than are worked at together.
constexpr std::size_t kStamps = 64;
/// Pictures that wait in the reader: what drivers of cameras and ROS 2's profile for sensors have.
constexpr int kDepth = 5;

}  // namespace

TopicSource::TopicSource(Node& node, TopicSourceOptions options)
    : node_(node), options_(std::move(options)), last_s_(now_s()) {}

std::optional<Frame> TopicSource::next() {
  while (!stopped_) {
    if (!topics_) find_topics();
    node_.wait(kBetweenQuestions);
    if (!topics_) {
      say_if_silent();
      continue;
    }
    take_messages();
    try {
      std::optional<TopicFrame> made = frames_->next(now_s());
      for (const std::string& note : frames_->take_notes()) options_.say("note: " + note);
      if (!made) {
        say_if_silent();
        continue;
      }
      last_s_ = now_s();
      said_silent_ = false;
      const std::scoped_lock lock(mutex_);
      stamps_.emplace_back(made->frame.name, made->stamp);
      if (stamps_.size() > kStamps) stamps_.pop_front();
      return std::move(made->frame);
    } catch (const Error& e) {
      complain(e.what());
    }
  }
  return std::nullopt;
}

Stamp TopicSource::stamp_of(const Frame& frame) const {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find(stamps_, frame.name, &std::pair<std::string, Stamp>::first);
  return found == stamps_.end() ? Stamp{} : found->second;
}

void TopicSource::find_topics() {
  std::vector<std::string> published;
  for (TopicType& topic : node_.published()) {
    if (topic.type == "sensor_msgs/Image") published.push_back(std::move(topic.name));
  }
  const std::optional<CameraTopics> chosen = choose_topics(options_.name_space, options_.topics, published);
  if (!chosen) return;
  if (found_s_ == 0.0) found_s_ = now_s();
  const bool is_named = !options_.topics.depth.empty();
  if (is_named || !chosen->colour.empty() || now_s() - found_s_ > kForColour_s) open(*chosen);
}

void TopicSource::open(const CameraTopics& topics) {
  const Qos qos{.reliable = options_.reliable, .latched = false, .depth = kDepth};
  depth_ = node_.subscribe(topics.depth, picture_type(topics.depth), qos);
  camera_info_ = node_.subscribe(topics.camera_info, "sensor_msgs/CameraInfo", qos);
  if (!topics.colour.empty()) colour_ = node_.subscribe(topics.colour, picture_type(topics.colour), qos);
  topics_ = topics;
  frames_.emplace(topics, options_.stored);
  options_.say(fmt::format("depth of {}, calibration of {}, {}", topics.depth, topics.camera_info,
                           topics.colour.empty() ? "no colour" : "colour of " + topics.colour));
}

void TopicSource::take_messages() {
  const auto take_all = [&](Subscription* from, const auto& take) {
    while (from != nullptr) {
      const std::optional<std::string> message = from->take();
      if (!message) return;
      try {
        take(*message);
      } catch (const Error& e) {
        complain(e.what());
      }
    }
  };
  take_all(camera_info_.get(), [&](const std::string& message) { frames_->take_calibration(message); });
  take_all(colour_.get(), [&](const std::string& message) { frames_->take_colour(message); });
  take_all(depth_.get(), [&](const std::string& message) { frames_->take_depth(message, now_s()); });
}

void TopicSource::complain(const std::string& line) {
  if (complaints_.size() > kMostComplaints || !complaints_.insert(line).second) return;
  options_.say(complaints_.size() <= kMostComplaints ? line
                                                     : "further messages that cannot be used are left out silently");
}

void TopicSource::say_if_silent() {
  if (said_silent_ || now_s() - last_s_ < kSilence_s) return;
  said_silent_ = true;
  if (!topics_) {
    options_.say(fmt::format("no topic of depth below {} yet; waiting (--depth-topic names one)", options_.name_space));
  } else if (frames_->lacks_calibration()) {
    options_.say(fmt::format("no calibration on {} yet; waiting", topics_->camera_info));
  } else {
    options_.say(fmt::format("no depth on {} for {:.0f} s; waiting", topics_->depth, kSilence_s));
  }
}

}  // namespace vesalius::ros2
