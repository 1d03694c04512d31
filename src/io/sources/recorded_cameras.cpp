#include "io/sources/recorded_cameras.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "io/recordings/camera_topics.h"
#include "io/sources/camera_file.h"
#include "io/sources/pcd.h"
#include "io/sources/recorded_topics.h"
#include "io/sources/source_items.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Kind = PictureLook::Kind;

/// Names that a line lists; a recording may have thousands.
constexpr std::size_t kMostNamed = 4, kMostItems = 60;

std::string names_of(const std::vector<const PictureTopic*>& topics) {
  std::string text;
  for (std::size_t i = 0; i < std::min(topics.size(), kMostNamed); ++i) {
    text += (i == 0 ? "" : ", ") + topics[i]->topic.name;
  }
  return topics.size() > kMostNamed ? fmt::format("{} and {} more", text, topics.size() - kMostNamed) : text;
}

std::string size_of(const PictureTopic& picture) {
  return fmt::format("{}x{}", picture.look.width, picture.look.height);
}

/// Returns whether pictures are of depth by how they are encoded and what their name says.
bool is_taken_for_depth(const PictureTopic& picture) {
  if (!picture.look.is_depth()) return false;
  if (picture.points || picture.disparities) return true;
  return picture.name == TopicName::depth || (picture.look.kind == Kind::depth && picture.name != TopicName::other);
}

/// Returns why pictures that have an encoding of colour are not taken for it; nothing if they are.
std::string why_no_colour(const PictureTopic& picture) {
  const bool is_grey = picture.look.kind == Kind::grey || picture.look.is_depth();
  if (picture.look.kind == Kind::unread) return picture.look.why;
  if (picture.name == TopicName::other || (is_grey && picture.name == TopicName::depth)) return "by its name no colour";
  if (is_grey && picture.name != TopicName::colour) return "grey, and its name does not say colour";
  return {};
}

bool is_taken_for_colour(const PictureTopic& picture) {
  return !is_taken_for_depth(picture) && !picture.points && why_no_colour(picture).empty();
}

const PictureTopic& choose_depth_topic(const RecordedContents& contents, const SourceOptions& options,
                                       const std::string& place, std::vector<std::string>& notes) {
  std::vector<const PictureTopic*> depths;
  for (const PictureTopic& picture : contents.pictures) {
    const bool may_be = options.depth_topic.empty() ? is_taken_for_depth(picture) : picture.look.is_depth();
    if (may_be) depths.push_back(&picture);
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
  if (depths.empty()) {
    throw Error(place + ": no depth, expected a topic of pictures of 16UC1, mono16, 32FC1 or compressedDepth");
  }
  const auto rank = [](const PictureTopic* d) {
    const bool may_be_labels = d->look.encoding == "32SC1";
    return std::tuple(d->points, d->disparities, d->name != TopicName::depth, may_be_labels, !d->is_registered(),
                      d->compressed);
  };
  std::ranges::stable_sort(depths, {}, rank);
  std::erase_if(depths, [&](const auto* d) { return d->points && !depths.front()->points; });
  if (depths.size() > 1) {
    notes.push_back(fmt::format("{}: depth of {}; there is also {}", place, depths.front()->topic.name,
                                names_of({depths.begin() + 1, depths.end()})));
  }
  const PictureTopic& chosen = *depths.front();
  if (chosen.left_out > 0) {
    notes.push_back(fmt::format("{}: {} of {} before the first frame left out: no pixels, too few, or another size",
                                place, chosen.left_out == 1 ? "1 message" : fmt::format("{} messages", chosen.left_out),
                                chosen.topic.name));
  }
  return chosen;
}

/// Number of characters that two names have in common at their beginning.
std::size_t common(const std::string& a, const std::string& b) {
  return static_cast<std::size_t>(std::ranges::mismatch(a, b).in1 - a.begin());
}

/// Returns what was recorded nearest to a topic by their beginnings, else by what they say; null if nothing was.
template <class T>
const std::pair<std::string, T>* nearest(const std::vector<std::pair<std::string, T>>& all, const std::string& topic) {
  const TopicName says = name_says(topic);
  const auto found = std::ranges::max_element(
      all, {}, [&](const auto& one) { return std::pair(common(one.first, topic), name_says(one.first) == says); });
  return found == all.end() ? nullptr : &*found;
}

struct TopicCamera {
  std::string topic;  ///< topic of the calibration
  CalibratedCamera camera;
  std::string remark;  ///< how it was made to fit
};

/// Returns the namespace of a topic: what a camera's pictures and their calibration have in common.
std::string_view beside(std::string_view topic) {
  const std::string_view plain = without_transport(topic);
  return plain.substr(0, plain.rfind('/'));
}

/// How well a calibration goes with pictures, the less the better; nothing where it does not.
std::optional<std::pair<bool, bool>> misfit(const std::pair<std::string, Calibration>& one,
                                            const PictureTopic& picture) {
  const Calibration& c = one.second;
  const auto scaled = scaled_to(c, picture.look.width, picture.look.height);
  if (!scaled || !(scaled->matrix[0] > 0.0 && scaled->matrix[4] > 0.0)) return std::nullopt;
  const bool is_beside = beside(one.first) == beside(picture.topic.name);
  const bool other_size = c.width != picture.look.width || c.height != picture.look.height;
  const bool is_named = !c.frame.empty() && !picture.frame.empty();
  const bool other_frame = is_named && c.frame != picture.frame;
  if (!is_beside && (other_frame || (other_size && !is_named))) return std::nullopt;
  return std::pair(other_frame, other_size);
}

/// Returns the camera of a topic: the calibration of its size and coordinate frame that was recorded nearest to it by
/// name; else one that can be scaled to its size, or stands beside it and names another frame.
std::optional<TopicCamera> camera_of(const RecordedContents& contents, const PictureTopic& picture) {
  std::map<std::pair<bool, bool>, std::vector<std::pair<std::string, Calibration>>> fitting;
  for (const auto& one : contents.calibrations) {
    if (const auto how = misfit(one, picture)) fitting[*how].push_back(one);
  }
  if (fitting.empty()) return std::nullopt;
  auto& [how, best] = *fitting.begin();
  // RealSense: what the library states is right, its messages of sensor_msgs call every lens plumb_bob.
  const auto is_own = [](const auto& one) { return one.first == realsense_stream(one.first) + "/camera_info"; };
  if (std::ranges::any_of(best, is_own)) std::erase_if(best, [&](const auto& one) { return !is_own(one); });
  const auto& [topic, calibration] = *nearest(best, picture.topic.name);
  std::string remark;
  if (how.first) remark = fmt::format("of the coordinate frame {}, pictures of {}", calibration.frame, picture.frame);
  if (how.second) {
    remark += fmt::format("{}for {}x{} pixels, scaled to {}", remark.empty() ? "" : "; ", calibration.width,
                          calibration.height, size_of(picture));
  }
  const auto scaled = scaled_to(calibration, picture.look.width, picture.look.height);
  return TopicCamera{topic, calibrated(*scaled, picture.is_rectified()), remark};
}

/// Returns the camera that the first points of a topic lie on the grid of.
CameraFacts facts_of_points(Recording& recording, const PictureTopic& points, const std::string& place) {
  CameraFacts facts;
  while (const auto message = recording.next()) {
    const RecordedTopic& topic = recording.topics()[message->topic];
    if (topic.name != points.topic.name || !whole_picture(topic, message->bytes)) continue;
    facts = estimate_camera({points_of(parse_picture(topic, message->bytes, place), place), {}}, place);
    break;
  }
  recording.rewind();
  return facts;
}

CameraFacts facts_of(const RecordedContents& contents, const PictureTopic& depth, const std::string& place,
                     std::vector<std::string>& notes) {
  CameraFacts facts;
  if (const auto found = camera_of(contents, depth)) {
    const CalibratedCamera* camera = &found->camera;
    facts.origin = fmt::format("{}: {}", place, found->topic);
    facts.width = depth.look.width;
    facts.height = depth.look.height;
    facts.fx = camera->pinhole.fx;
    facts.fy = camera->pinhole.fy;
    facts.cx = camera->pinhole.cx;
    facts.cy = camera->pinhole.cy;
    facts.odd_lens = camera->odd_model;
    if (camera->lens.lens != Lens{}) facts.distorted = camera->lens;
    if (!found->remark.empty()) {
      notes.push_back(fmt::format("{}: camera of {}, {}", place, found->topic, found->remark));
    }
  }
  if (const auto* units = nearest(contents.units_m, depth.topic.name); units != nullptr && units->second > 1e-6F) {
    facts.depth_scale = 1.F / units->second;
  }
  return facts;
}

/// Returns how colour becomes that of the pixels of depth; nothing if nothing says so.
std::optional<RecordedCameras::Colour> connect(const RecordedContents& contents, const PictureTopic& depth,
                                               const PictureTopic& colour) {
  const auto transform = contents.transforms.find(colour.frame, depth.frame);
  const auto found = camera_of(contents, colour);
  if (!transform || !found || !found->camera.odd_model.empty()) return std::nullopt;
  return RecordedCameras::Colour{colour.topic.name,  colour.time_s, colour.recorded_s,
                                 found->camera.lens, *transform,    {}};
}

/// Colour that lies on the grid of depth.
RecordedCameras::Colour on_grid(const RecordedContents& contents, const PictureTopic& colour,
                                const std::optional<LensCamera>& depth_lens) {
  RecordedCameras::Colour on_grid{
      colour.topic.name, colour.time_s, colour.recorded_s, {}, Eigen::Isometry3d::Identity(), {}};
  if (const auto found = camera_of(contents, colour)) {
    if (found->camera.lens.lens != Lens{}) on_grid.distorted = found->camera.lens;
  } else if (!colour.is_rectified()) {
    on_grid.distorted = depth_lens;
  }
  return on_grid;
}

/// Returns the colour of a topic that the user named.
RecordedCameras::Colour named_colour(const RecordedContents& contents, const PictureTopic& depth,
                                     const SourceOptions& options, const std::optional<LensCamera>& depth_lens,
                                     const std::string& place) {
  const auto named = std::ranges::find_if(contents.pictures, [&](const PictureTopic& picture) {
    return picture.look.kind != Kind::unread && !picture.points && picture.topic.name == options.colour_topic;
  });
  if (named == contents.pictures.end()) {
    throw UsageError(fmt::format("{}: no pictures of topic {}", place, options.colour_topic));
  }
  const bool same_size = named->same_size(depth);
  const bool elsewhere = !same_size || (named->frame != depth.frame && !depth.is_registered());
  if (elsewhere) {
    if (auto connected = connect(contents, depth, *named)) return *connected;
  }
  if (!same_size) {
    throw Error(fmt::format(
        "{}: {} has {} pixels, {} {}, expected colour registered to depth, or calibrations and a transform of both",
        place, named->topic.name, size_of(*named), depth.topic.name, size_of(depth)));
  }
  return on_grid(contents, *named, depth_lens);
}

/// Messages of video, which are in no picture's message.
bool is_video(const RecordedTopic& topic) {
  return topic.messages != 0 && !is_picture(topic) &&
         (topic.type.ends_with("CompressedVideo") || topic.type.ends_with("/Packet"));
}

/// Returns why topics that have pictures give no colour: one after the other.
std::string why_none(const Recording& recording, const RecordedContents& contents) {
  std::string text;
  for (const PictureTopic& picture : contents.pictures) {
    const std::string why = why_no_colour(picture);
    const bool is_silent = picture.name == TopicName::other && picture.look.kind != Kind::unread;
    if (why.empty() || is_silent || is_taken_for_depth(picture) || picture.look.is_depth()) continue;
    const bool has_flag = picture.look.kind != Kind::unread && picture.name != TopicName::depth;
    text += fmt::format("; {} ({}): {}{}", picture.topic.name, picture.look.encoding, why,
                        has_flag ? ", --colour-topic takes it" : "");
  }
  for (const RecordedTopic& topic : recording.topics()) {
    if (is_video(topic)) text += fmt::format("; {} ({}): video is not read", topic.name, topic.type);
  }
  return text;
}

std::optional<RecordedCameras::Colour> choose_colour(const Recording& recording, const RecordedContents& contents,
                                                     const PictureTopic& depth,
                                                     const std::optional<LensCamera>& depth_lens,
                                                     const std::string& place, std::vector<std::string>& notes) {
  std::vector<const PictureTopic*> colours, others;
  for (const PictureTopic& picture : contents.pictures) {
    if (&picture == &depth || !is_taken_for_colour(picture)) continue;
    const bool same_place = !depth.frame.empty() && depth.frame == picture.frame;
    (picture.same_size(depth) && (depth.is_registered() || same_place) ? colours : others).push_back(&picture);
  }
  const auto rank = [](const PictureTopic* one) {
    return std::tuple(one->look.kind != Kind::colour, one->name == TopicName::depth, one->compressed);
  };
  std::ranges::stable_sort(colours, {}, rank);
  if (!colours.empty()) return on_grid(contents, *colours.front(), depth_lens);
  std::ranges::stable_sort(others, {}, rank);
  for (const PictureTopic* other : others) {
    if (auto connected = connect(contents, depth, *other)) return connected;
  }
  std::string why = why_none(recording, contents);
  if (!others.empty()) {
    why = fmt::format("; {} is not registered to {}{}", names_of(others), depth.topic.name, why);
  }
  if (!why.empty()) notes.push_back(fmt::format("{}: no colour, since {}", place, why.substr(2)));
  return std::nullopt;
}

/// Returns the device of a RealSense stream; the accelerometer of one has the axes of its depth camera.
std::string device_of(const std::string& stream) { return stream.substr(0, stream.find('/', 1)); }

std::optional<RecordedCameras::Acceleration> choose_acceleration(const RecordedContents& contents,
                                                                 const PictureTopic& depth) {
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

/// Returns why a picture was not taken, where one of depth was.
std::string why_not(const PictureTopic& picture, const PictureTopic* depth) {
  if (is_taken_for_depth(picture)) return "another depth; --depth-topic takes it";
  if (picture.points) return picture.look.encoding.starts_with("xyz") ? "" : "points are read where they lie in rows";
  if (picture.look.is_depth()) {
    const bool is_other = picture.name == TopicName::other;
    return fmt::format("{}; --depth-topic takes it", is_other ? "by its name no depth" : "its name does not say depth");
  }
  std::string why = why_no_colour(picture);
  if (depth == nullptr || picture.look.kind == Kind::unread) return why;
  if (!picture.same_size(*depth)) return fmt::format("not {} as depth, and nothing connects them", size_of(*depth));
  if (why.empty() && picture.frame != depth->frame) {
    why =
        fmt::format("of the coordinate frame {}, depth of {}, and nothing connects them", picture.frame, depth->frame);
  }
  return fmt::format("{}{}--colour-topic takes it", why, why.empty() ? "" : "; ");
}

std::string why_not(const Calibration& calibration, const PictureTopic* depth) {
  if (!(calibration.matrix[0] > 0.0)) return "no focal length, all zeros; --fx gives one";
  if (depth == nullptr) return {};
  if (!scaled_to(calibration, depth->look.width, depth->look.height)) {
    return fmt::format("not for the {} pixels of depth", size_of(*depth));
  }
  if (calibration.frame == depth->frame) return {};
  return fmt::format("of the coordinate frame {}, depth of {}", calibration.frame, depth->frame);
}

/// Describes a topic that no other function does.
SourceItem plain_item(const RecordedTopic& topic) {
  SourceItem item{topic.name, topic.type, long(topic.messages), {}, {}};
  const auto is_like = [&](std::string_view word) { return topic.type.find(word) != std::string::npos; };
  const bool is_wanted = is_like("Image") || is_like("CameraInfo") || is_like("CameraCalibration");
  if (topic.messages == 0) {
    item.why = "empty";
  } else if (topic.layout == MessageLayout::other && is_wanted) {
    item.why = "messages in another encoding, expected CDR, ROS 1, Protocol Buffers or JSON";
  } else if (is_video(topic)) {
    item.why = "video is not read";
  } else if (is_picture(topic)) {
    item.why = "no whole picture seen";
  } else if (is_like("RGBD")) {  // of the RealSense driver and of RTAB-Map
    item.why = "depth and colour in one message are not read, expected the topics that it is made of";
  } else if (is_like("PointCloud")) {
    item.why = "expected sensor_msgs/PointCloud2";
  } else if (is_transform(topic)) {
    item.use = "transforms";
  }
  return item;
}

/// Describes every topic. `cameras` are those chosen so far, of `depth` if there is one.
std::vector<SourceItem> items_of(const Recording& recording, const RecordedContents& contents,
                                 const RecordedCameras& cameras, const PictureTopic* depth) {
  std::vector<SourceItem> items;
  const auto camera_topic = [&](const PictureTopic& of) {
    return camera_of(contents, of).value_or(TopicCamera{}).topic;
  };
  const std::string camera = depth == nullptr ? "" : camera_topic(*depth);
  std::string colour_camera;
  for (const PictureTopic& picture : contents.pictures) {
    if (cameras.colour && cameras.colour->topic == picture.topic.name) colour_camera = camera_topic(picture);
  }
  std::size_t listed = 0;
  for (const RecordedTopic& topic : recording.topics()) {
    if (items.size() == kMostItems) break;
    ++listed;
    // Bags have a connection for each of several programs that publish a topic.
    if (const auto same = std::ranges::find(items, topic.name, &SourceItem::name); same != items.end()) {
      same->count += long(topic.messages);
      continue;
    }
    SourceItem& item = items.emplace_back(plain_item(topic));
    for (const PictureTopic& picture : contents.pictures) {
      if (picture.topic.name != topic.name) continue;
      item.holds += " " + picture.look.encoding;
      if (picture.look.width > 0) item.holds += " " + size_of(picture);
      const bool is_colour = cameras.colour && cameras.colour->topic == topic.name;
      item.use = &picture == depth ? "depth" : is_colour ? "colour" : "";
      item.why = item.use.empty() ? why_not(picture, depth) : "";
    }
    const auto calibration =
        std::ranges::find(contents.calibrations, topic.name, &std::pair<std::string, Calibration>::first);
    if (calibration != contents.calibrations.end()) {
      item.holds += fmt::format(" {}x{}", calibration->second.width, calibration->second.height);
      item.use = topic.name == camera ? "camera of depth" : topic.name == colour_camera ? "camera of colour" : "";
      item.why = item.use.empty() ? why_not(calibration->second, depth) : "";
    }
    if (cameras.acceleration && cameras.acceleration->topic == topic.name) item.use = "up";
    const bool is_unit = std::ranges::any_of(contents.units_m, [&](const auto& of) { return of.first == topic.name; });
    if (is_unit) item.use = "unit of depth";
  }
  if (const std::size_t rest = recording.topics().size() - listed; rest > 0) {
    items.push_back({fmt::format("and {} topics more", rest), "", -1, "not listed", ""});
  }
  return items;
}

}  // namespace

RecordedCameras choose_cameras(Recording& recording, const SourceOptions& options, const std::string& place,
                               std::vector<std::string>& notes) {
  const RecordedContents contents = look_into(recording, place);
  RecordedCameras cameras;
  const PictureTopic* depth = nullptr;
  try {
    depth = &choose_depth_topic(contents, options, place, notes);
    cameras.depth = {depth->topic.name,
                     depth->look.width,
                     depth->look.height,
                     depth->time_s,
                     depth->recorded_s,
                     depth->left_out,
                     facts_of(contents, *depth, place, notes)};
    if (depth->points && !cameras.depth.facts.fx && !options.fx && options.camera_file.empty()) {
      cameras.depth.facts = facts_of_points(recording, *depth, place);
      notes.push_back(fmt::format("{}: camera of {} estimated from its points", place, depth->topic.name));
    }
    const std::optional<LensCamera>& lens = cameras.depth.facts.distorted;
    cameras.colour = options.colour_topic.empty() ? choose_colour(recording, contents, *depth, lens, place, notes)
                                                  : named_colour(contents, *depth, options, lens, place);
  } catch (const UsageError&) {
    throw;
  } catch (const Error& e) {
    throw Error(with_items(e.what(), items_of(recording, contents, cameras, depth)));
  }
  cameras.acceleration = choose_acceleration(contents, *depth);
  cameras.items = items_of(recording, contents, cameras, depth);
  return cameras;
}

}  // namespace vesalius
