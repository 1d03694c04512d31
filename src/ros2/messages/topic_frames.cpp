#include "ros2/messages/topic_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/files/stored_depth.h"
#include "io/recordings/recording.h"
#include "io/sources/camera_file.h"
#include "io/sources/depth_check.h"
#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

constexpr std::uint64_t kMostApart_ns = 50'000'000;
/// Colour that comes later than this after depth would cost more than it is worth.
constexpr double kMostWait_s = 0.1;
/// Pictures that wait: a third of a second at 30 a second.
constexpr std::size_t kMostWaiting = 10;

/// Depth and the colour on its grid, below the camera's namespace, the best first.
struct Driver {
  const char *depth, *colour;
};
constexpr std::array<Driver, 10> kDrivers{{
    {"aligned_depth_to_color/image_raw", "color/image_raw"},  // RealSense
    {"depth_registered/image_rect", "rgb/image_rect_color"},  // image_proc, OpenNI
    {"depth_registered/image_raw", "rgb/image_raw"},          //
    {"depth_to_rgb/image_raw", "rgb/image_raw"},              // Azure Kinect
    {"depth/image_rect", "color/image_rect"},                 // vesalius ros2
    {"depth/image_rect_raw", "color/image_raw"},              // RealSense
    {"depth/image_raw", "color/image_raw"},                   // Orbbec and others
    {"depth/image", "color/image"},                           //
    {"stereo/image_raw", "rgb/image_raw"},                    // OAK
    {"depth/depth_registered", "rgb/image_rect_color"},       // ZED
}};

bool is_compressed(const std::string& topic) {
  return topic.ends_with("/compressed") || topic.ends_with("/compressedDepth");
}

RecordedTopic topic_of(const std::string& name, const char* type) { return {name, type, MessageLayout::cdr}; }

bool is_registered(const std::string& topic) {
  for (const char* word : {"aligned", "registered", "depth_to_rgb"}) {
    if (topic.find(word) != topic.npos) return true;
  }
  return false;
}

}  // namespace

std::string camera_info_of(const std::string& topic) {
  std::string pictures = topic;
  if (is_compressed(topic)) pictures.resize(pictures.rfind('/'));
  return pictures.substr(0, pictures.rfind('/')) + "/camera_info";
}

const char* picture_type(const std::string& topic) {
  return is_compressed(topic) ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image";
}

std::optional<CameraTopics> choose_topics(const std::string& name_space, const CameraTopics& wanted,
                                          const std::vector<std::string>& published) {
  const std::string before = name_space == "/" ? "" : name_space;
  const auto is_published = [&](const std::string& topic) {
    return std::ranges::find(published, topic) != published.end();
  };
  CameraTopics chosen = wanted;
  for (const Driver& driver : kDrivers) {
    if (!chosen.depth.empty()) break;
    const std::string depth = fmt::format("{}/{}", before, driver.depth);
    if (!is_published(depth)) continue;
    chosen.depth = depth;
    const std::string colour = fmt::format("{}/{}", before, driver.colour);
    if (chosen.colour.empty() && is_published(colour)) chosen.colour = colour;
  }
  if (chosen.depth.empty()) return std::nullopt;
  if (chosen.camera_info.empty()) chosen.camera_info = camera_info_of(chosen.depth);
  return chosen;
}

TopicFrames::TopicFrames(CameraTopics topics, SourceOptions stored)
    : topics_(std::move(topics)), stored_(std::move(stored)), unchecked_(kFirstFrames) {}

void TopicFrames::note_once(const std::string& key, const std::string& line) {
  if (!std::exchange(noted_[key], true)) notes_.push_back(line);
}

void TopicFrames::take_calibration(std::string_view message) {
  const std::string& place = topics_.camera_info;
  const Calibration calibration = parse_calibration(topic_of(place, "sensor_msgs/CameraInfo"), message, place);
  const CalibratedCamera found = calibrated(calibration, topics_.depth.find("rect") != std::string::npos);
  try {
    check(found.pinhole);
    check(found.lens.camera);
  } catch (const Error& e) {
    throw Error(fmt::format("{}: {}", place, e.what()));
  }
  if (!found.odd_model.empty()) {
    note_once("lens", fmt::format("{}: a lens distorts by the model {}, which is not undone", place, found.odd_model));
  }
  // Cameras repeat it with every picture.
  if (camera_ == found.pinhole && lens_.camera == found.lens.camera && lens_.lens == found.lens.lens) return;
  camera_ = found.pinhole;
  lens_ = found.lens;
  rectification_.reset();
}

TopicFrames::Picture TopicFrames::parse(const std::string& topic, std::string_view message) {
  Picture one;
  one.message = std::make_shared<const std::string>(message);
  one.picture = parse_picture(topic_of(topic, picture_type(topic)), *one.message, topic);
  return one;
}

void TopicFrames::take_depth(std::string_view message, double arrived_s) {
  Picture one = parse(topics_.depth, message);
  if (!is_depth(one.picture)) {
    throw Error(fmt::format("{}: a picture of \"{}\", expected depth as 16UC1, mono16 or 32FC1", topics_.depth,
                            one.picture.encoding));
  }
  one.arrived_s = arrived_s;
  depths_.push_back(std::move(one));
  if (depths_.size() > kMostWaiting) depths_.pop_front();
}

void TopicFrames::take_colour(std::string_view message) {
  colours_.push_back(parse(topics_.colour, message));
  if (colours_.size() > kMostWaiting) colours_.pop_front();
}

bool TopicFrames::is_complete(const Picture& depth, double now_s) const {
  if (topics_.colour.empty() || depths_.size() > 2 || now_s - depth.arrived_s > kMostWait_s) return true;
  return std::ranges::any_of(colours_, [&](const Picture& c) { return c.picture.time_ns >= depth.picture.time_ns; });
}

ColourImage TopicFrames::colour_for(const Picture& depth, const DepthImage& image) {
  const auto apart = [&](const Picture& c) { return apart_ns(c.picture.time_ns, depth.picture.time_ns); };
  const auto nearest = std::ranges::min_element(colours_, {}, apart);
  if (nearest == colours_.end() || apart(*nearest) > kMostApart_ns) return {};
  const bool same_place = nearest->picture.frame == depth.picture.frame || is_registered(topics_.depth);
  ColourImage colour;
  if (same_place) colour = colour_of(nearest->picture, topics_.colour);
  if (!colour.same_size(image)) {
    note_once("colour", fmt::format("{}: no colour, since it is not registered to {}", topics_.colour, topics_.depth));
    return {};
  }
  return rectified(rectification_, std::move(colour));
}

DepthImage TopicFrames::depth_from(const PictureMessage& picture) {
  const auto read = [&](const SourceOptions& stored) { return depth_of(picture, stored_depth(stored), topics_.depth); };
  DepthImage depth = read(stored_);
  if (unchecked_ > 0 && (has_depth(depth) || --unchecked_ == 0)) {
    unchecked_ = 0;
    if (std::string doubt = doubt_of_depth(depth, topics_.depth, stored_, read); !doubt.empty()) {
      notes_.push_back(std::move(doubt));
    }
  }
  return depth;
}

std::optional<TopicFrame> TopicFrames::next(double now_s) {
  if (!camera_ || depths_.empty() || !is_complete(depths_.front(), now_s)) return std::nullopt;
  const Picture depth = std::move(depths_.front());
  depths_.pop_front();
  TopicFrame made;
  const std::int64_t time_ns = depth.picture.time_ns;
  made.stamp = {time_ns, depth.picture.frame};
  made.frame.time_s = double(time_ns) / double(kNanoseconds);
  made.frame.name = name_of_time(time_ns);
  made.frame.arrived_s = depth.arrived_s;
  made.frame.camera = *camera_;
  made.frame.depth = depth_from(depth.picture);
  if (made.frame.depth.width() != camera_->width || made.frame.depth.height() != camera_->height) {
    throw Error(fmt::format("{}: {}x{} pixels, expected {}x{} as {} says", topics_.depth, made.frame.depth.width(),
                            made.frame.depth.height(), camera_->width, camera_->height, topics_.camera_info));
  }
  // Not before: a calibration may state any size, a picture of that size has the bytes to show for it.
  if (lens_.lens != Lens{} && !rectification_) rectification_ = make_rectification(lens_, *camera_);
  if (!colours_.empty()) {
    try {
      made.frame.colour = colour_for(depth, made.frame.depth);
    } catch (const Error& e) {
      note_once("colour", e.what());
    }
  }
  if (rectification_) made.frame.depth = rectification_->depth(made.frame.depth);
  return made;
}

}  // namespace vesalius::ros2
