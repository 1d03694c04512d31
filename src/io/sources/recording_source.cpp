#include "io/sources/recording_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <exception>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "io/recordings/camera_messages.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/open_recording.h"
#include "io/sources/camera_file.h"
#include "io/sources/folder_source.h"
#include "vesalius/base/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMostApart_ns = 50'000'000;
/// Frames that wait for their colour: half a second at 30 a second.
constexpr std::size_t kMostWaiting = 15;
/// Messages in which every topic must have shown itself.
constexpr int kMostProbed = 5000;
constexpr std::int64_t kNanoseconds = 1'000'000'000;
/// How long before the time of a seek reading begins: what two streams may lie apart in the file.
constexpr double kLead_s = 0.5;
/// By how much more, where that was not early enough.
constexpr double kFurther = 4.0;

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
  double time_s = 0.0;        ///< of the picture
  double recorded_s = 0.0;    ///< when it was recorded
};

double seconds(std::int64_t time_ns) { return static_cast<double>(time_ns) / static_cast<double>(kNanoseconds); }

/// Returns the nearest time that there is.
std::int64_t nanoseconds(double time_s) {
  constexpr double kMost_s = 9.2e9;
  if (time_s < -kMost_s) return std::numeric_limits<std::int64_t>::min();
  if (time_s > kMost_s) return std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(time_s * static_cast<double>(kNanoseconds));
}

/// Returns when a picture was taken by its header, or recorded where that does not say.
std::int64_t time_of(const PictureMessage& picture, const RecordedMessage& message) {
  return picture.time_ns != 0 ? picture.time_ns : message.time_ns;
}

/// What a recording has for a camera.
struct Contents {
  std::vector<PictureTopic> pictures;
  std::vector<std::pair<std::string, Calibration>> calibrations;  ///< with their topics
  std::vector<std::pair<std::string, float>> units_m;             ///< RealSense: metres of a unit of depth
};

PictureTopic look_at(const RecordedTopic& topic, const RecordedMessage& message, const std::string& place) {
  const PictureMessage picture = parse_picture(topic, message.bytes, place);
  PictureTopic seen{topic,
                    picture.encoding,
                    picture.frame,
                    picture.compressed,
                    is_depth(picture),
                    picture.width,
                    picture.height,
                    seconds(time_of(picture, message)),
                    seconds(message.time_ns)};
  // Infrared pictures are of 16 bits too.
  if (picture.encoding == "mono16" && !has_word(topic.name, "depth")) seen.depth = false;
  try {
    if (seen.depth) {
      const DepthImage depth = depth_of(picture, 1000.F, place);
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

/// Reads until every topic that matters has shown itself.
Contents look_into(Recording& recording, const std::string& place) {
  Contents contents;
  std::map<std::size_t, bool> wanted;
  for (std::size_t t = 0; t < recording.topics().size(); ++t) {
    const RecordedTopic& topic = recording.topics()[t];
    if (topic.messages != 0 && (is_picture(topic) || is_calibration(topic) || is_depth_unit(topic))) wanted[t] = true;
  }
  for (int i = 0; i < kMostProbed && !wanted.empty(); ++i) {
    const std::optional<RecordedMessage> message = recording.next();
    if (!message) break;
    if (wanted.erase(message->topic) == 0) continue;
    const RecordedTopic& topic = recording.topics()[message->topic];
    if (is_picture(topic)) {
      contents.pictures.push_back(look_at(topic, *message, place));
    } else if (is_calibration(topic)) {
      contents.calibrations.emplace_back(topic.name, parse_calibration(topic, message->bytes, place));
    } else {
      contents.units_m.emplace_back(topic.name, depth_unit(topic, *message, place));
    }
  }
  recording.rewind();
  return contents;
}

std::string names_of(const std::vector<const PictureTopic*>& topics) {
  std::string text;
  for (const PictureTopic* topic : topics) text += (text.empty() ? "" : ", ") + topic->topic.name;
  return text;
}

const PictureTopic& choose_depth(const Contents& contents, const SourceOptions& options, const std::string& place,
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
  const auto rank = [](const PictureTopic* d) {
    const bool registered = has_word(d->topic.name, "aligned") || has_word(d->topic.name, "registered");
    return std::pair(registered ? 0 : 1, d->compressed ? 1 : 0);
  };
  std::ranges::stable_sort(depths, {}, rank);
  if (depths.size() > 1) {
    notes.push_back(fmt::format("{}: depth of {}; there is also {}", place, depths.front()->topic.name,
                                names_of({depths.begin() + 1, depths.end()})));
  }
  return *depths.front();
}

/// Returns the topic whose colour is registered to this depth, null if there is none.
const PictureTopic* choose_colour(const Contents& contents, const PictureTopic& depth, const SourceOptions& options,
                                  const std::string& place, std::vector<std::string>& notes) {
  std::vector<const PictureTopic*> colours, others;
  for (const PictureTopic& picture : contents.pictures) {
    if (picture.depth) continue;
    if (!options.colour_topic.empty()) {
      if (picture.topic.name == options.colour_topic) colours.push_back(&picture);
      continue;
    }
    const bool aligned = has_word(depth.topic.name, "aligned") || has_word(depth.topic.name, "registered");
    const bool same_place = !depth.frame.empty() && depth.frame == picture.frame;
    const bool is_colour = picture.encoding != "mono8" && picture.encoding != "8UC1" && picture.width > 0;
    if (!is_colour) continue;
    const bool fits = picture.width == depth.width && picture.height == depth.height && (aligned || same_place);
    (fits ? colours : others).push_back(&picture);
  }
  if (!options.colour_topic.empty() && colours.empty()) {
    throw UsageError(fmt::format("{}: no pictures of topic {}", place, options.colour_topic));
  }
  if (colours.empty()) {
    if (!others.empty()) {
      notes.push_back(
          fmt::format("{}: no colour, since {} is not registered to {}", place, names_of(others), depth.topic.name));
    }
    return nullptr;
  }
  std::ranges::stable_sort(colours, {}, &PictureTopic::compressed);
  const PictureTopic* colour = colours.front();
  if (colour->width != depth.width || colour->height != depth.height) {
    throw Error(fmt::format("{}: {} has {}x{} pixels, {} {}x{}, expected colour registered to depth", place,
                            colour->topic.name, colour->width, colour->height, depth.topic.name, depth.width,
                            depth.height));
  }
  return colour;
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

CameraFacts facts_of(const Contents& contents, const PictureTopic& depth, const std::string& place) {
  CameraFacts facts;
  std::vector<std::pair<std::string, Calibration>> fitting;
  for (const auto& one : contents.calibrations) {
    const Calibration& c = one.second;
    const bool same_place = c.frame.empty() || depth.frame.empty() || c.frame == depth.frame;
    if (c.width == depth.width && c.height == depth.height && same_place && c.matrix[0] > 0.0) fitting.push_back(one);
  }
  if (const auto* one = nearest(fitting, depth.topic.name)) {
    const Calibration& c = one->second;
    facts.origin = fmt::format("{}: {}", place, one->first);
    facts.width = c.width;
    facts.height = c.height;
    facts.distorted = c.is_distorted();
    const bool rectified = facts.distorted && has_word(depth.topic.name, "rect") && c.projection[0] > 0.0;
    const std::array<double, 4> of =
        rectified ? std::array{c.projection[0], c.projection[5], c.projection[2], c.projection[6]}
                  : std::array{c.matrix[0], c.matrix[4], c.matrix[2], c.matrix[5]};
    if (rectified) facts.distorted = false;
    facts.fx = static_cast<float>(of[0]);
    facts.fy = static_cast<float>(of[1]);
    facts.cx = static_cast<float>(of[2]);
    facts.cy = static_cast<float>(of[3]);
  }
  if (const auto* units = nearest(contents.units_m, depth.topic.name); units != nullptr && units->second > 1e-6F) {
    facts.depth_scale = 1.F / units->second;
  }
  return facts;
}

std::string name_of(std::int64_t time_ns) {
  return fmt::format("{}.{:09}", time_ns / kNanoseconds, std::abs(time_ns % kNanoseconds));
}

class RecordingSource final : public FrameSource {
 public:
  RecordingSource(std::vector<std::string> files, const SourceOptions& options) : files_(std::move(files)) {
    for (const std::string& file : files_) recordings_.push_back(open_recording(file));
    const std::string& place = files_.front();
    const Contents contents = look_into(*recordings_.front(), place);
    const PictureTopic& depth = choose_depth(contents, options, place, notes_);
    depth_topic_ = depth.topic.name;
    if (const PictureTopic* colour = choose_colour(contents, depth, options, place, notes_))
      colour_topic_ = colour->topic.name;
    CameraFacts facts = find_camera_facts(options, {});
    facts.fill_from(facts_of(contents, depth, place));
    camera_ = resolve_camera(facts, depth.width, depth.height, !colour_topic_.empty(), place, notes_);
    units_per_m_ = facts.depth_scale.value_or(1000.F);
    for (const auto& recording : recordings_) {
      for (std::string& note : recording->notes()) notes_.push_back(std::move(note));
    }
    recorded_later_s_ = depth.recorded_s - depth.time_s;
    span_ = {depth.time_s, std::max(depth.time_s, last_time_s().value_or(depth.time_s))};
    go_to(-std::numeric_limits<double>::infinity());
  }

  std::optional<Frame> next() override {
    while (!is_ready()) {
      try {
        if (const auto message = next_message()) take(*message);
      } catch (const Error&) {
        if (!wanted_from_s_) throw;
        failed_ = std::current_exception();
      }
      if (failed_ && !wanted_from_s_) std::rethrow_exception(std::exchange(failed_, nullptr));
    }
    if (failed_) std::rethrow_exception(std::exchange(failed_, nullptr));
    if (waiting_.empty()) return std::nullopt;
    return with_colour();
  }

  std::optional<TimeSpan> span() const override { return span_; }

  void seek(double time_s) override {
    const double aim_s = std::clamp(std::isnan(time_s) ? span_.first_s : time_s, span_.first_s, span_.last_s + kLead_s);
    // Messages are found by when they were recorded, which may drift from when they were taken: depth must be found
    // that is old enough.
    for (double back_s = 2.0 * kLead_s; go_to(aim_s - back_s); back_s *= kFurther) {
      const std::optional<double> first_s = next_depth_time_s();
      if (!first_s || *first_s > aim_s - kLead_s) continue;
      go_to(aim_s - back_s);
      break;
    }
    wanted_from_s_ = time_s;
  }

  int size() const override {
    std::int64_t frames = 0;
    for (const auto& recording : recordings_) {
      for (const RecordedTopic& topic : recording->topics()) {
        if (topic.name != depth_topic_) continue;
        if (topic.messages < 0) return -1;
        frames += topic.messages;
      }
    }
    return static_cast<int>(frames);
  }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  struct Colour {
    std::int64_t time_ns;
    RecordedTopic topic;
    std::string message;
  };
  struct Waiting {
    std::int64_t time_ns;
    Frame frame;
  };

  /// Goes to the messages recorded when those of `time_s` were. Returns whether any before were left out.
  bool go_to(double time_s) {
    const std::int64_t time_ns = nanoseconds(time_s + recorded_later_s_);
    bool left_out = false;
    for (at_ = 0; at_ + 1 < recordings_.size(); ++at_) {
      const std::optional<std::int64_t> last_ns = recordings_[at_]->last_ns();
      if (last_ns >= time_ns) break;
      left_out = left_out || last_ns.has_value();
    }
    if (recordings_[at_]->seek(time_ns)) left_out = true;
    for (std::size_t later = at_ + 1; later < recordings_.size(); ++later) recordings_[later]->rewind();
    waiting_.clear();
    colours_.clear();
    last_name_.clear();
    failed_ = nullptr;
    wanted_from_s_.reset();
    return left_out;
  }

  std::optional<RecordedMessage> next_message() {
    for (; at_ < recordings_.size(); ++at_) {
      if (auto message = recordings_[at_]->next()) return message;
    }
    return std::nullopt;
  }

  /// Returns the time of the next depth that is not damaged.
  std::optional<double> next_depth_time_s() {
    while (at_ < recordings_.size()) {
      try {
        const auto message = next_message();
        if (!message) continue;
        const RecordedTopic& topic = recordings_[at_]->topics()[message->topic];
        if (topic.name != depth_topic_) continue;
        return seconds(time_of(parse_picture(topic, message->bytes, files_[at_]), *message));
      } catch (const Error&) {  // whoever asks for the frame hears of it
      }
    }
    return std::nullopt;
  }

  std::optional<double> last_time_s() {
    std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
    for (const auto& recording : recordings_) last_ns = std::max(last_ns, recording->last_ns().value_or(last_ns));
    const double end_s = seconds(last_ns) - recorded_later_s_;
    std::optional<double> last_s;
    for (double back_s = 0.0;; back_s = std::max(kLead_s, back_s * kFurther)) {
      const bool left_out = go_to(end_s - back_s);
      while (const auto time_s = next_depth_time_s()) last_s = time_s;
      if (last_s || !left_out) return last_s;
    }
  }

  /// Returns whether nothing is left to read, or the first frame's colour has come if it ever will.
  bool is_ready() const {
    if (at_ == recordings_.size()) return true;
    if (waiting_.empty()) return false;
    if (colour_topic_.empty() || waiting_.size() >= kMostWaiting) return true;
    return !colours_.empty() && colours_.back().time_ns >= waiting_.front().time_ns;
  }

  void take(const RecordedMessage& message) {
    const RecordedTopic& topic = recordings_[at_]->topics()[message.topic];
    const std::string& place = files_[at_];
    const bool is_depth = topic.name == depth_topic_;
    if (!is_depth && (colour_topic_.empty() || topic.name != colour_topic_)) return;
    const PictureMessage picture = parse_picture(topic, message.bytes, place);
    const std::int64_t time_ns = time_of(picture, message);
    if (!is_depth) {
      colours_.push_back({time_ns, topic, std::string(message.bytes)});
      if (colours_.size() > 2 * kMostWaiting) colours_.pop_front();
      return;
    }
    Frame frame;
    frame.time_s = seconds(time_ns);
    if (wanted_from_s_ && *frame.time_s < *wanted_from_s_) {
      failed_ = nullptr;
      return;
    }
    wanted_from_s_.reset();
    frame.name = name_of(time_ns);
    // Another frame of the same time, and yet another.
    while (last_name_.starts_with(frame.name)) frame.name += "_again";
    last_name_ = frame.name;
    frame.camera = camera_;
    frame.depth = depth_of(picture, units_per_m_, fmt::format("{}: {}", place, frame.name));
    if (frame.depth.width() != camera_.width || frame.depth.height() != camera_.height) {
      throw Error(fmt::format("{}: {}: {}x{} pixels, expected {}x{} as before", place, frame.name, frame.depth.width(),
                              frame.depth.height(), camera_.width, camera_.height));
    }
    waiting_.push_back({time_ns, std::move(frame)});
  }

  Frame with_colour() {
    Waiting one = std::move(waiting_.front());
    waiting_.pop_front();
    const auto apart = [&](const Colour& colour) { return std::abs(colour.time_ns - one.time_ns); };
    const auto nearest = std::ranges::min_element(colours_, {}, apart);
    if (nearest != colours_.end() && apart(*nearest) <= kMostApart_ns) {
      const std::string name = fmt::format("{}: {}", files_[std::min(at_, files_.size() - 1)], one.frame.name);
      ColourImage colour = colour_of(parse_picture(nearest->topic, nearest->message, name), name);
      if (colour.same_size(one.frame.depth)) one.frame.colour = std::move(colour);
    }
    while (!colours_.empty() && colours_.front().time_ns < one.time_ns - kMostApart_ns) colours_.pop_front();
    return std::move(one.frame);
  }

  std::vector<std::string> files_;
  std::vector<std::unique_ptr<Recording>> recordings_;
  std::size_t at_ = 0;  ///< recording that is being read
  std::string depth_topic_, colour_topic_;
  Camera camera_;
  float units_per_m_ = 1000.F;
  std::vector<std::string> notes_;
  std::deque<Waiting> waiting_;
  std::deque<Colour> colours_;
  std::string last_name_;
  TimeSpan span_;
  double recorded_later_s_ = 0.0;  ///< by how much messages were recorded after they were taken, about
  /// After a seek, until a frame has come that is not earlier.
  std::optional<double> wanted_from_s_;
  std::exception_ptr failed_;  ///< what could not be read since the last frame that was too early
};

}  // namespace

std::unique_ptr<FrameSource> open_recorded(const std::string& path, const SourceOptions& options) {
  std::vector<std::string> files;
  if (fs::is_directory(path)) {
    for (const fs::path& file : list_files(path, {".mcap", ".db3"})) files.push_back(file.string());
    if (files.empty()) throw Error(path + ": no recording, expected *.mcap or *.db3");
  } else {
    files.push_back(path);
  }
  return std::make_unique<RecordingSource>(std::move(files), options);
}

}  // namespace vesalius
