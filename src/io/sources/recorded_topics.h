#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/picture_look.h"
#include "io/recordings/recording.h"
#include "io/recordings/transform_messages.h"

namespace vesalius {

/// What the name of a topic says that its pictures are of.
enum class TopicName { nothing, depth, colour, other };

/// Reads a name as people give them: "/camera/aligned_depth_to_color/image_raw" is depth, "/kinect2/sd/image_ir" other.
/// Of several words the last one counts, and none that stands behind "to".
TopicName name_says(std::string_view topic);

/// Returns the name of the pictures that a topic of image_transport has compressed.
std::string_view without_transport(std::string_view topic);

/// What the first usable message of a topic of pictures shows.
struct PictureTopic {
  RecordedTopic topic;
  PictureLook look;
  TopicName name = TopicName::nothing;
  std::string frame;
  bool compressed = false;
  bool points = false, disparities = false;
  double time_s = 0.0;      ///< time of the picture
  double recorded_s = 0.0;  ///< when it was recorded
  int left_out = 0;         ///< messages before it that are no whole pictures, or of a size of their own

  bool same_size(const PictureTopic& other) const {
    return look.width == other.look.width && look.height == other.look.height;
  }
  bool is_registered() const;
  bool is_rectified() const;
};

/// What a recording has for a camera.
struct RecordedContents {
  std::vector<PictureTopic> pictures;                               ///< in the order in which they appear
  std::vector<std::pair<std::string, Calibration>> calibrations;    ///< with their topics
  std::vector<std::pair<std::string, Acceleration>> accelerations;  ///< the first of each topic
  std::vector<std::pair<std::string, float>> units_m;               ///< RealSense: metres of a unit of depth
  TransformTree transforms;
};

/// Looks at a message's picture; nothing where it has no size, or not all its bytes as far as that shows without
/// decoding.
std::optional<PictureLook> whole_picture(const RecordedTopic& topic, std::string_view message);

/// Reads messages until every topic that matters has shown itself, and transforms had their time; for depth and its
/// calibration as long as it takes, for others some thousand messages. Decodes no picture. The recording is rewound.
RecordedContents look_into(Recording& recording, const std::string& place);

}  // namespace vesalius
