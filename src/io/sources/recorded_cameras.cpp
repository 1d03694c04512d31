#include "io/sources/recorded_cameras.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <utility>

#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/realsense_topics.h"
#include "io/recordings/transform_messages.h"
#include "io/sources/camera_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Messages in which every topic must have shown itself.
constexpr int kMostProbed = 5000;
/// After that, so long transforms may still come.
constexpr std::int64_t kForTransforms_ns = 1'000'000'000;
/// So long topics are waited for that may have no message at all.
constexpr std::int64_t kForOthers_ns = 20'000'000'000;

bool has_word(const std::string& text, std::string_view word) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), same) != text.end();
}

/// What the first message of a topic of pictures shows.
struct PictureTopic {
  RecordedTopic topic;
  std::string encoding, frame;
  bool compressed = false, depth = false;
  int width = 0, height = 0;  ///< 0 = could not be decoded
  double time_s = 0.0;        ///< time of the picture
  double recorded_s = 0.0;    ///< when it was recorded

  bool is_registered() const { return has_word(topic.name, "aligned") || has_word(topic.name, "registered"); }
  bool is_rectified() const { return has_word(topic.name, "rect"); }
};

/// What a recording has for a camera.
struct Contents {
  std::vector<PictureTopic> pictures;
  std::vector<std::pair<std::string, Calibration>> calibrations;    ///< with their topics
  std::vector<std::pair<std::string, Acceleration>> accelerations;  ///< the first of each topic
  std::vector<std::pair<std::string, float>> units_m;               ///< RealSense: metres of a unit of depth
  TransformTree transforms;
};

PictureTopic look_at(const RecordedTopic& topic, const RecordedMessage& message, const std::string& place) {
  const PictureMessage picture = parse_picture(topic, message.bytes, place);
  const std::int64_t time_ns = picture.time_ns != 0 ? picture.time_ns : message.time_ns;
  PictureTopic seen{topic,
                    picture.encoding,
                    picture.frame,
                    picture.compressed,
                    is_depth(picture),
                    picture.width,
                    picture.height,
                    double(time_ns) / double(kNanoseconds),
                    double(message.time_ns) / double(kNanoseconds)};
  // Infrared pictures are of 16 bits too.
  if (picture.encoding == "mono16" && !has_word(topic.name, "depth")) seen.depth = false;
  try {
    if (seen.depth) {
      const DepthImage depth = depth_of(picture, {}, place);
      seen.width = depth.width();
      seen.height = depth.height();
    } else {
      const ColourImage colour = colour_of(picture, place);
      seen.width = colour.width();
      seen.height = colour.height();
    }
  } catch (const Error&) {
    if (!seen.depth) seen.width = seen.height = 0;
  }
  return seen;
}

/// RealSense cameras: how many metres a unit of depth is, as a number (ROS 1) or as text (ROS 2).
bool is_depth_unit(const RecordedTopic& topic) {
  const bool is_value = topic.type == "std_msgs/Float32" || topic.type == "std_msgs/String";
  return is_value && topic.layout != MessageLayout::protobuf && topic.name.ends_with("/Depth_Units/value");
}

float depth_unit(const RecordedTopic& topic, const RecordedMessage& message, const std::string& place) {
  MessageFields fields(message.bytes, topic.layout, place);
  if (topic.type == "std_msgs/Float32") return fields.real32("the unit of depth");
  const std::string_view text = fields.text("the unit of depth");
  float unit_m = 0.F;
  std::from_chars(text.data(), text.data() + text.size(), unit_m);
  return unit_m;
}

/// Returns whether a time is more than `by_ns` after another. Times of damaged files may be any number.
bool is_later(std::int64_t time_ns, std::int64_t than_ns, std::int64_t by_ns) {
  return double(time_ns) - double(than_ns) > double(by_ns);
}

/// Reads until every topic that matters has shown itself, and transforms had their time.
Contents look_into(Recording& recording, const std::string& place) {
  Contents contents;
  std::map<std::size_t, bool> wanted;
  bool has_transforms = false;
  for (std::size_t t = 0; t < recording.topics().size(); ++t) {
    const RecordedTopic& topic = recording.topics()[t];
    if (topic.messages == 0) continue;
    const bool matters = is_picture(topic) || is_calibration(topic) || is_acceleration(topic) || is_depth_unit(topic);
    if (matters) wanted[t] = true;
    if (is_transform(topic)) has_transforms = true;
  }
  const auto may_be_empty = [&](const auto& one) { return recording.topics()[one.first].messages < 0; };
  std::optional<std::int64_t> first_ns, complete_ns;
  for (int i = 0; i < kMostProbed && (!wanted.empty() || has_transforms); ++i) {
    const std::optional<RecordedMessage> message = recording.next();
    if (!message || (complete_ns && is_later(message->time_ns, *complete_ns, kForTransforms_ns))) break;
    if (!first_ns) first_ns = message->time_ns;
    const bool is_late = is_later(message->time_ns, *first_ns, kForOthers_ns);
    if (is_late && !complete_ns && std::ranges::all_of(wanted, may_be_empty)) break;
    const RecordedTopic& topic = recording.topics()[message->topic];
    if (is_transform(topic)) {
      for (const FrameTransform& one : parse_transforms(topic, message->bytes, place)) contents.transforms.add(one);
    } else if (wanted.erase(message->topic) == 0) {
      continue;
    } else if (is_picture(topic)) {
      contents.pictures.push_back(look_at(topic, *message, place));
    } else if (is_calibration(topic)) {
      contents.calibrations.emplace_back(topic.name, parse_calibration(topic, message->bytes, place));
    } else if (is_acceleration(topic)) {
      contents.accelerations.emplace_back(topic.name, parse_acceleration(topic, message->bytes, place));
    } else {
      contents.units_m.emplace_back(topic.name, depth_unit(topic, *message, place));
    }
    if (wanted.empty() && !complete_ns) complete_ns = message->time_ns;
  }
  recording.rewind();
  return contents;
}

std::string names_of(const std::vector<const PictureTopic*>& topics) {
  std::string text;
  for (const PictureTopic* topic : topics) text += (text.empty() ? "" : ", ") + topic->topic.name;
  return text;
}

const PictureTopic& choose_depth_topic(const Contents& contents, const SourceOptions& options, const std::string& place,
                                       std::vector<std::string>& notes) {
  std::vector<const PictureTopic*> depths;
  for (const PictureTopic& picture : contents.pictures) {
    if (picture.depth) depths.push_back(&picture);
  }
  if (depths.empty()) {
    throw Error(place + ": no depth, expected a topic of pictures of 16UC1, mono16, 32FC1 or compressedDepth");
  }
  if (!options.depth_topic.empty()) {
    const auto named =
        std::ranges::find_if(depths, [&](const auto* d) { return d->topic.name == options.depth_topic; });
    if (named == depths.end()) {
      throw UsageError(
          fmt::format("{}: no depth of topic {}, expected {}", place, options.depth_topic, names_of(depths)));
    }
    return **named;
  }
  const auto rank = [](const PictureTopic* d) { return std::pair(d->is_registered() ? 0 : 1, d->compressed ? 1 : 0); };
  std::ranges::stable_sort(depths, {}, rank);
  if (depths.size() > 1) {
    notes.push_back(fmt::format("{}: depth of {}; there is also {}", place, depths.front()->topic.name,
                                names_of({depths.begin() + 1, depths.end()})));
  }
  return *depths.front();
}

/// Number of characters that two names have in common at their beginning.
std::size_t common(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

/// Returns what was recorded nearest to a topic; null if nothing was.
template <class T>
const std::pair<std::string, T>* nearest(const std::vector<std::pair<std::string, T>>& all, const std::string& topic) {
  const auto found = std::ranges::max_element(all, {}, [&](const auto& one) { return common(one.first, topic); });
  return found == all.end() ? nullptr : &*found;
}

struct TopicCamera {
  std::string topic;  ///< topic of the calibration
  CalibratedCamera camera;
};

/// Returns the camera of a topic: of its size and coordinate frame, and recorded nearest to it by name.
std::optional<TopicCamera> camera_of(const Contents& contents, const PictureTopic& picture) {
  std::vector<std::pair<std::string, Calibration>> fitting;
  for (const auto& one : contents.calibrations) {
    const Calibration& c = one.second;
    const bool same_place = c.frame.empty() || picture.frame.empty() || c.frame == picture.frame;
    const bool usable = c.matrix[0] > 0.0 && c.matrix[4] > 0.0;
    if (c.width == picture.width && c.height == picture.height && same_place && usable) fitting.push_back(one);
  }
  // RealSense: what the library states is right, its messages of sensor_msgs call every lens plumb_bob.
  const auto is_own = [](const auto& one) { return one.first == realsense_stream(one.first) + "/camera_info"; };
  if (std::ranges::any_of(fitting, is_own)) std::erase_if(fitting, [&](const auto& one) { return !is_own(one); });
  const auto* one = nearest(fitting, picture.topic.name);
  if (one == nullptr) return std::nullopt;
  return TopicCamera{one->first, calibrated(one->second, picture.is_rectified())};
}

CameraFacts facts_of(const Contents& contents, const PictureTopic& depth, const std::string& place) {
  CameraFacts facts;
  if (const auto found = camera_of(contents, depth)) {
    const CalibratedCamera* camera = &found->camera;
    facts.origin = fmt::format("{}: {}", place, found->topic);
    facts.width = depth.width;
    facts.height = depth.height;
    facts.fx = camera->pinhole.fx;
    facts.fy = camera->pinhole.fy;
    facts.cx = camera->pinhole.cx;
    facts.cy = camera->pinhole.cy;
    facts.odd_lens = camera->odd_model;
    if (camera->lens.lens != Lens{}) facts.distorted = camera->lens;
  }
  if (const auto* units = nearest(contents.units_m, depth.topic.name); units != nullptr && units->second > 1e-6F) {
    facts.depth_scale = 1.F / units->second;
  }
  return facts;
}

/// Returns how colour becomes that of the pixels of depth; nothing if nothing says so.
std::optional<RecordedCameras::Colour> connect(const Contents& contents, const PictureTopic& depth,
                                               const PictureTopic& colour) {
  const auto transform = contents.transforms.find(colour.frame, depth.frame);
  const auto found = camera_of(contents, colour);
  if (!transform || !found || !found->camera.odd_model.empty()) return std::nullopt;
  return RecordedCameras::Colour{colour.topic.name, found->camera.lens, *transform, {}};
}

/// Colour that lies on the grid of depth.
RecordedCameras::Colour on_grid(const Contents& contents, const PictureTopic& colour,
                                const std::optional<LensCamera>& depth_lens) {
  RecordedCameras::Colour on_grid{colour.topic.name, {}, Eigen::Isometry3d::Identity(), {}};
  if (const auto found = camera_of(contents, colour)) {
    if (found->camera.lens.lens != Lens{}) on_grid.distorted = found->camera.lens;
  } else if (!colour.is_rectified()) {
    on_grid.distorted = depth_lens;
  }
  return on_grid;
}

/// Returns the colour of a topic that the user named.
RecordedCameras::Colour named_colour(const Contents& contents, const PictureTopic& depth, const SourceOptions& options,
                                     const std::optional<LensCamera>& depth_lens, const std::string& place) {
  const auto named = std::ranges::find_if(contents.pictures, [&](const PictureTopic& picture) {
    return !picture.depth && picture.topic.name == options.colour_topic;
  });
  if (named == contents.pictures.end()) {
    throw UsageError(fmt::format("{}: no pictures of topic {}", place, options.colour_topic));
  }
  const bool same_size = named->width == depth.width && named->height == depth.height;
  const bool elsewhere = !same_size || (named->frame != depth.frame && !depth.is_registered());
  if (elsewhere) {
    if (auto connected = connect(contents, depth, *named)) return *connected;
  }
  if (!same_size) {
    throw Error(fmt::format(
        "{}: {} has {}x{} pixels, {} {}x{}, expected colour registered to depth, or calibrations and a "
        "transform of both",
        place, named->topic.name, named->width, named->height, depth.topic.name, depth.width, depth.height));
  }
  return on_grid(contents, *named, depth_lens);
}

std::optional<RecordedCameras::Colour> choose_colour(const Contents& contents, const PictureTopic& depth,
                                                     const std::optional<LensCamera>& depth_lens,
                                                     const std::string& place, std::vector<std::string>& notes) {
  std::vector<const PictureTopic*> colours, others;
  for (const PictureTopic& picture : contents.pictures) {
    if (picture.depth) continue;
    const bool same_place = !depth.frame.empty() && depth.frame == picture.frame;
    const bool is_colour = picture.encoding != "mono8" && picture.encoding != "8UC1" && picture.width > 0;
    if (!is_colour) continue;
    const bool same_size = picture.width == depth.width && picture.height == depth.height;
    (same_size && (depth.is_registered() || same_place) ? colours : others).push_back(&picture);
  }
  std::ranges::stable_sort(colours, {}, &PictureTopic::compressed);
  if (!colours.empty()) return on_grid(contents, *colours.front(), depth_lens);
  std::ranges::stable_sort(others, {}, &PictureTopic::compressed);
  for (const PictureTopic* other : others) {
    if (auto connected = connect(contents, depth, *other)) return connected;
  }
  if (!others.empty()) {
    notes.push_back(
        fmt::format("{}: no colour, since {} is not registered to {}", place, names_of(others), depth.topic.name));
  }
  return std::nullopt;
}

/// Returns the device of a RealSense stream; the accelerometer of one has the axes of its depth camera.
std::string device_of(const std::string& stream) { return stream.substr(0, stream.find('/', 1)); }

std::optional<RecordedCameras::Acceleration> choose_acceleration(const Contents& contents, const PictureTopic& depth) {
  std::optional<RecordedCameras::Acceleration> chosen;
  for (const auto& [topic, first] : contents.accelerations) {
    if (!depth.frame.empty() && first.frame == depth.frame) {
      return RecordedCameras::Acceleration{topic, Eigen::Matrix3d::Identity()};
    }
    if (chosen) continue;
    if (const auto transform = contents.transforms.find(depth.frame, first.frame)) {
      chosen = {topic, transform->linear()};
    } else if (const std::string stream = realsense_stream(topic);
               !stream.empty() && device_of(stream) == device_of(depth.frame)) {
      chosen = {topic, Eigen::Matrix3d::Identity()};
    }
  }
  return chosen;
}

}  // namespace

RecordedCameras choose_cameras(Recording& recording, const SourceOptions& options, const std::string& place,
                               std::vector<std::string>& notes) {
  const Contents contents = look_into(recording, place);
  const PictureTopic& depth = choose_depth_topic(contents, options, place, notes);
  RecordedCameras cameras;
  cameras.depth = {depth.topic.name, depth.width,      depth.height,
                   depth.time_s,     depth.recorded_s, facts_of(contents, depth, place)};
  const std::optional<LensCamera>& lens = cameras.depth.facts.distorted;
  cameras.colour = options.colour_topic.empty() ? choose_colour(contents, depth, lens, place, notes)
                                                : named_colour(contents, depth, options, lens, place);
  cameras.acceleration = choose_acceleration(contents, depth);
  return cameras;
}

}  // namespace vesalius
