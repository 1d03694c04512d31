#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/recording.h"
#include "ros2/messages/people_topics.h"
#include "vesalius/frame.h"
#include "vesalius/frame_source.h"

namespace vesalius::ros2 {

/// The topics that frames are made of; full names.
struct CameraTopics {
  std::string depth, camera_info;
  std::string colour;  ///< empty: frames have none
};

/// Chooses a camera's topics below a namespace such as "/camera" among what is published: depth that is registered to
/// colour before depth that is not, as drivers of common cameras name them; `wanted` has those that the user named.
/// Returns nothing while there is no depth.
std::optional<CameraTopics> choose_topics(const std::string& name_space, const CameraTopics& wanted,
                                          const std::vector<std::string>& published);

/// Returns the topic of the calibration that goes with pictures: "/camera/depth/camera_info" of
/// "/camera/depth/image_raw".
std::string camera_info_of(const std::string& topic);

/// Returns the type of a topic of pictures: that of compressed ones where its name ends as image_transport has it.
const char* picture_type(const std::string& topic);

/// A frame made of messages.
struct TopicFrame {
  Frame frame;
  Stamp stamp;  ///< as the depth picture says
};

/// Puts frames together of messages as they arrive: sensor_msgs/Image of depth (16UC1 or mono16 millimetres, 32FC1
/// metres) and of colour, CompressedImage of both, and CameraInfo. A depth picture goes with the colour nearest in
/// time, at most 50 ms away, for which it waits no longer than 100 ms; with colour that has another size or stands in
/// another frame it goes alone. What a lens did to depth and colour is undone. Without a calibration there are no
/// frames. Of the first ones with depth that no camera gives in a room there is a note.
class TopicFrames {
 public:
  /// `stored` says how depth is stored; the rest of it counts nothing.
  explicit TopicFrames(CameraTopics topics, SourceOptions stored = {});

  // Take a message as CDR. `arrived_s` is when, by this machine's clock. All throw Error naming the topic where the
  // message is not what it should be; it is left out then.
  void take_calibration(std::string_view message);
  void take_depth(std::string_view message, double arrived_s);
  void take_colour(std::string_view message);

  /// Returns the next frame that is complete; nothing if none is. Throws Error naming the topic where a picture is not
  /// what it says; it is left out then.
  std::optional<TopicFrame> next(double now_s);

  /// Returns whether depth has come that lacks a calibration.
  bool lacks_calibration() const { return !camera_ && !depths_.empty(); }
  /// Returns remarks that have not been asked for yet, each once.
  std::vector<std::string> take_notes() { return std::exchange(notes_, {}); }

 private:
  struct Picture {
    PictureMessage picture;                      ///< its data are in `message`
    std::shared_ptr<const std::string> message;  ///< does not move when this does
    double arrived_s = 0.0;
  };

  static Picture parse(const std::string& topic, std::string_view message);
  void note_once(const std::string& key, const std::string& line);
  bool is_complete(const Picture& depth, double now_s) const;
  DepthImage depth_from(const PictureMessage& picture);
  ColourImage colour_for(const Picture& depth, const DepthImage& image);

  CameraTopics topics_;
  SourceOptions stored_;
  int unchecked_;  ///< pictures one of which should have depth
  std::optional<Camera> camera_;
  LensCamera lens_;
  std::optional<Rectification> rectification_;  ///< made with the first picture of the camera
  std::deque<Picture> depths_, colours_;
  std::map<std::string, bool> noted_;
  std::vector<std::string> notes_;
};

}  // namespace vesalius::ros2
