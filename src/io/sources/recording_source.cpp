#include "io/sources/recording_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "io/files/av_pictures.h"
#include "io/files/video_stream.h"
#include "io/lens/colour_registration.h"
#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/open_recording.h"
#include "io/sources/camera_file.h"
#include "io/sources/recorded_cameras.h"
#include "io/sources/recorded_topics.h"
#include "io/sources/recording_files.h"
#include "io/sources/source_items.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostApart_ns = 50'000'000;
/// Frames that wait for their colour: half a second at 30 a second.
constexpr std::size_t kMostWaiting = 15;
/// Fewer where they are larger than this together, and so are the colour pictures that wait for them.
constexpr std::size_t kMostWaitingBytes = std::size_t{1} << 28;
/// How long before the time of a seek reading begins: what two streams may lie apart in the file.
constexpr double kLead_s = 0.5;
/// By how much more, where that was not early enough.
constexpr double kFurther = 4.0;

double seconds(std::int64_t time_ns) { return double(time_ns) / double(kNanoseconds); }

/// Returns the nearest time that there is.
std::int64_t nanoseconds(double time_s) {
  constexpr double kMost_s = 9.2e9;
  if (time_s < -kMost_s) return std::numeric_limits<std::int64_t>::min();
  if (time_s > kMost_s) return std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>(time_s * double(kNanoseconds));
}

/// Returns when a picture was taken by its header, or recorded where that does not say.
std::int64_t time_of(const PictureMessage& picture, const RecordedMessage& message) {
  return picture.time_ns != 0 ? picture.time_ns : message.time_ns;
}

class RecordingSource final : public FrameSource {
 public:
  RecordingSource(std::vector<std::string> files, const SourceOptions& options) : files_(std::move(files)) {
    for (const std::string& file : files_) recordings_.push_back(open_recording(file));
    const std::string& place = files_.front();
    RecordedCameras cameras = choose_in_first(options);
    items_ = std::move(cameras.items);
    count_items();
    const RecordedCameras::Depth& depth = cameras.depth;
    CameraFacts facts = find_camera_facts(options, {});
    facts.fill_from(depth.facts);
    const bool on_grid = cameras.colour && !cameras.colour->camera;
    camera_ = camera_from(facts, depth, on_grid, place);
    stored_ = {facts.depth_scale.value_or(1000.F), options.depth_scale.value_or(1.F), options.depth_bits};
    depth_topic_ = depth.topic;
    left_out_ = depth.left_out;
    first_recorded_s_ = depth.recorded_s;
    rectification_ = make_rectification(facts.distorted, camera_);
    if (cameras.colour) use_colour(*cameras.colour);
    acceleration_ = cameras.acceleration;
    for (const auto& recording : recordings_) {
      for (std::string& note : recording->notes()) notes_.push_back(std::move(note));
    }
    recorded_later_s_ = depth.recorded_s - depth.time_s;
    span_ = {depth.time_s, std::max(depth.time_s, last_time_s().value_or(depth.time_s))};
    if (cameras.colour) compare_clocks(depth, *cameras.colour, place);
    go_to(-std::numeric_limits<double>::infinity());
  }

  std::optional<Frame> next() override {
    while (!is_ready()) {
      try {
        if (const auto message = next_message()) {
          take_message(*message);
        } else if (video_ && apart_.empty()) {
          take_decoded(video_->decode({}, 0));
        }
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
      for (auto later_s = first_s; video_key_ == VideoKey::wanted && later_s && *later_s < aim_s;) {
        later_s = next_depth_time_s();
      }
      if (video_key_ == VideoKey::wanted) continue;
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
    return int(frames) - left_out_;
  }
  std::vector<std::string> notes() const override { return notes_; }
  std::vector<SourceItem> contents() const override { return items_; }

 private:
  struct Colour {
    std::int64_t time_ns;
    RecordedTopic topic;
    std::string message;
    ColourImage decoded;  ///< of a video; `message` is empty
    std::size_t bytes() const { return message.size() + decoded.size() * sizeof(Rgb); }
  };
  struct Waiting {
    std::int64_t time_ns;
    Frame frame;
  };

  Camera camera_from(CameraFacts& facts, const RecordedCameras::Depth& depth, bool on_grid, const std::string& place) {
    try {
      return resolve_camera(facts, depth.width, depth.height, on_grid, place, notes_);
    } catch (const Error& e) {
      throw Error(with_items(e.what(), items_));
    }
  }

  /// Adds the messages of the other files of a folder.
  void count_items() {
    for (std::size_t i = 1; i < recordings_.size(); ++i) {
      for (const RecordedTopic& topic : recordings_[i]->topics()) {
        const auto same = std::ranges::find(items_, topic.name, &SourceItem::name);
        if (same == items_.end()) continue;
        same->count = same->count < 0 || topic.messages < 0 ? -1 : same->count + topic.messages;
      }
    }
  }

  /// What a recording lacks may lie behind where it was cut.
  RecordedCameras choose_in_first(const SourceOptions& options) {
    try {
      return choose_cameras(*recordings_.front(), options, files_.front(), notes_);
    } catch (const UsageError&) {
      throw;
    } catch (const Error& e) {
      const std::vector<std::string> cut = recordings_.front()->notes();
      if (cut.empty()) throw;
      std::string text = e.what();
      text.insert(std::min(text.find('\n'), text.size()), fmt::format(" ({})", cut.front()));  // a list may follow
      throw Error(text);
    }
  }

  /// Notes where the clocks that depth and colour have times of are so far apart that what was seen at one time does
  /// not come together. Colour that begins a little later does.
  void compare_clocks(const RecordedCameras::Depth& depth, const RecordedCameras::Colour& colour,
                      const std::string& place) {
    constexpr double kMostApart_s = 1e-9 * double(kMostApart_ns), kMostLate_s = 1.0;
    const double apart_s = (colour.time_s - colour.recorded_s) - (depth.time_s - depth.recorded_s);
    const double behind_s =
        std::max(colour.time_s - span_.last_s, span_.first_s - last_colour_s_.value_or(span_.last_s));
    if (behind_s > kMostApart_s) {
      notes_.push_back(
          fmt::format("{}: no colour within {:.0f} ms of any depth (nearest {:.3g} s away): {} is on another clock",
                      place, 1e3 * kMostApart_s, behind_s, colour.topic));
    } else if (std::abs(apart_s) > kMostLate_s) {
      notes_.push_back(fmt::format("{}: the clock of {} is {:.3g} s {} that of {}", place, colour.topic,
                                   std::abs(apart_s), apart_s > 0.0 ? "before" : "behind", depth.topic));
    }
  }

  void use_colour(const RecordedCameras::Colour& colour) {
    colour_topic_ = colour.topic;
    if (colour.camera) registration_.emplace(camera_, *colour.camera, colour.colour_from_depth);
    colour_rectification_ = make_rectification(colour.distorted, camera_);
  }

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
    rewind_colour();
    video_key_ = VideoKey::none;
    ups_.clear();
    last_time_ns_.reset();
    failed_ = nullptr;
    wanted_from_s_.reset();
    return left_out;
  }

  void rewind_colour() {
    colours_.clear();
    colour_bytes_ = 0;
    is_colour_lost_ = false;
    if (video_) video_->restart();
    apart_at_ = 0;
    for (const auto& recording : apart_) recording->rewind();
  }

  std::optional<RecordedMessage> next_message() {
    for (; at_ < recordings_.size(); ++at_) {
      if (auto message = recordings_[at_]->next()) return message;
    }
    return std::nullopt;
  }

  /// Reads colour where the file has it far from its depth, as programs write that go topic by topic: up to a time, by
  /// readers of its own.
  void read_colour_apart(std::int64_t to_ns) {
    for (std::size_t i = apart_.size(); i < files_.size(); ++i) apart_.push_back(open_recording(files_[i]));
    while (apart_at_ < apart_.size() && (colours_.empty() || colours_.back().time_ns < to_ns)) {
      try {
        const auto message = apart_[apart_at_]->next();
        if (!message && ++apart_at_ == apart_.size() && video_) take_decoded(video_->decode({}, 0));
        if (!message) continue;
        const RecordedTopic& topic = apart_[apart_at_]->topics()[message->topic];
        if (topic.name == colour_topic_) take_colour_message(topic, *message, files_[apart_at_]);
      } catch (const Error&) {  // whoever reads depth hears of it
      }
    }
  }

  /// Returns the time of the next depth that is not damaged, and learns those of colour on the way.
  std::optional<double> next_depth_time_s() {
    while (at_ < recordings_.size()) {
      try {
        const auto message = next_message();
        if (!message) continue;
        const RecordedTopic& topic = recordings_[at_]->topics()[message->topic];
        const bool is_depth = topic.name == depth_topic_;
        if (!is_depth && (colour_topic_.empty() || topic.name != colour_topic_)) continue;
        const PictureMessage picture = parse_picture(topic, message->bytes, files_[at_]);
        const double time_s = seconds(time_of(picture, *message));
        if (is_depth) return time_s;
        last_colour_s_ = std::max(last_colour_s_.value_or(time_s), time_s);  // messages may lie in any order
        note_video(picture);
      } catch (const Error&) {  // whoever asks for the frame hears of it
      }
    }
    return std::nullopt;
  }

  void note_video(const PictureMessage& picture) {
    if (!is_video(picture) || video_key_ == VideoKey::seen) return;
    video_key_ = is_key_message(video_codec(picture.encoding), picture.data) ? VideoKey::seen : VideoKey::wanted;
  }

  std::optional<double> last_time_s() {
    std::int64_t last_ns = std::numeric_limits<std::int64_t>::min();
    for (const auto& recording : recordings_) last_ns = std::max(last_ns, recording->last_ns().value_or(last_ns));
    const double end_s = seconds(last_ns) - recorded_later_s_;
    std::optional<double> last_s;
    for (double back_s = 0.0;; back_s = std::max(kLead_s, back_s * kFurther)) {
      const bool left_out = go_to(end_s - back_s);
      while (const auto time_s = next_depth_time_s()) last_s = std::max(last_s.value_or(*time_s), *time_s);
      if (last_s || !left_out) return last_s;
    }
  }

  /// Returns whether nothing is left to read, or the first frame's colour has come if it ever will.
  bool is_ready() const {
    if (at_ == recordings_.size()) return true;
    if (waiting_.empty()) return false;
    const std::size_t waiting_bytes = waiting_.size() * waiting_.front().frame.depth.size() * sizeof(std::uint16_t);
    if (colour_topic_.empty() || !apart_.empty() || waiting_.size() >= kMostWaiting ||
        waiting_bytes > kMostWaitingBytes)
      return true;
    return !colours_.empty() && colours_.back().time_ns >= waiting_.front().time_ns;
  }

  bool has_the_size(const std::optional<PictureLook>& look) const {
    return look && look->width == camera_.width && look->height == camera_.height;
  }

  void take_message(const RecordedMessage& message) {
    const RecordedTopic& topic = recordings_[at_]->topics()[message.topic];
    const std::string& place = files_[at_];
    if (acceleration_ && topic.name == acceleration_->topic && is_acceleration(topic))
      return take_acceleration(message);
    const bool is_depth = topic.name == depth_topic_;
    if (!is_depth && (colour_topic_.empty() || topic.name != colour_topic_ || !apart_.empty())) return;
    if (!is_depth) return take_colour_message(topic, message, place);
    const bool may_be_left_out = left_out_ > 0 && seconds(message.time_ns) <= first_recorded_s_;
    if (may_be_left_out && !has_the_size(whole_picture(topic, message.bytes))) return;
    const PictureMessage picture = parse_picture(topic, message.bytes, place);
    const std::int64_t time_ns = time_of(picture, message);
    Frame frame;
    frame.time_s = seconds(time_ns);
    if (wanted_from_s_ && *frame.time_s < *wanted_from_s_) {
      failed_ = nullptr;
      return;
    }
    wanted_from_s_.reset();
    frame.name = name_of_time(time_ns);
    of_this_time_ = time_ns == last_time_ns_ ? of_this_time_ + 1 : 1;
    last_time_ns_ = time_ns;
    if (of_this_time_ > 1) frame.name += fmt::format("_{}", of_this_time_);
    frame.camera = camera_;
    frame.depth = depth_of(picture, stored_, fmt::format("{}: {}", place, frame.name));
    if (frame.depth.width() != camera_.width || frame.depth.height() != camera_.height) {
      throw Error(fmt::format("{}: {}: {}x{} pixels, expected {}x{} as before", place, frame.name, frame.depth.width(),
                              frame.depth.height(), camera_.width, camera_.height));
    }
    if (colour_topic_.empty() && picture.rgb) frame.colour = rectified(rectification_, colour_of(picture, frame.name));
    if (rectification_) frame.depth = rectification_->depth(frame.depth);
    waiting_.push_back({time_ns, std::move(frame)});
  }

  void take_colour_message(const RecordedTopic& topic, const RecordedMessage& message, const std::string& place) {
    const PictureMessage picture = parse_picture(topic, message.bytes, place);
    const std::int64_t time_ns = time_of(picture, message);
    if (picture.data.empty()) return;  // as drivers send before the first picture
    if (is_video(picture)) return take_video(picture, time_ns);
    take_colour({time_ns, topic, std::string(message.bytes), {}});
  }

  void take_colour(Colour colour) {
    colour_bytes_ += colour.bytes();
    colours_.push_back(std::move(colour));
    while (colours_.size() > 2 * kMostWaiting || (colours_.size() > 1 && colour_bytes_ > kMostWaitingBytes)) {
      forget_colour();
      is_colour_lost_ = true;
    }
  }

  static bool is_video(const PictureMessage& picture) {
    return picture.compressed && !video_codec(picture.encoding).empty();
  }

  /// Pictures of a video build on those before: they are decoded one after the other, wanted or not.
  void take_video(const PictureMessage& picture, std::int64_t time_ns) {
    if (!video_) video_ = std::make_unique<VideoDecoder>(video_codec(picture.encoding));
    take_decoded(video_->decode(picture.data, time_ns));
  }

  void take_decoded(std::vector<VideoDecoder::Picture> pictures) {
    for (VideoDecoder::Picture& each : pictures) take_colour({each.time_ns, {}, {}, std::move(each.colour)});
  }

  void take_acceleration(const RecordedMessage& message) {
    const RecordedTopic& topic = recordings_[at_]->topics()[message.topic];
    const Acceleration acceleration = parse_acceleration(topic, message.bytes, files_[at_]);
    ups_.add(acceleration.time_ns != 0 ? acceleration.time_ns : message.time_ns,
             acceleration_->optical_from_sensor * acceleration.m_s2);
  }

  /// Puts colour on the grid of depth. Returns nothing for a picture of another size than the first.
  ColourImage registered(ColourImage colour, const DepthImage& depth) const {
    if (registration_ && registration_->fits(colour)) return (*registration_)(depth, colour);
    if (registration_ || !colour.same_size(depth)) return {};
    return rectified(colour_rectification_, std::move(colour));
  }

  void forget_colour() {
    colour_bytes_ -= colours_.front().bytes();
    colours_.pop_front();
  }

  Frame with_colour() {
    const bool may_be_elsewhere = !colour_topic_.empty() && (is_colour_lost_ || waiting_.size() >= kMostWaiting);
    Waiting one = std::move(waiting_.front());
    waiting_.pop_front();
    const auto apart = [&](const Colour& colour) { return apart_ns(colour.time_ns, one.time_ns); };
    const auto is_near = [&](const Colour& colour) { return apart(colour) <= kMostApart_ns; };
    const bool is_elsewhere = apart_.empty() && may_be_elsewhere && std::ranges::none_of(colours_, is_near);
    if (is_elsewhere) rewind_colour();
    if (is_elsewhere || !apart_.empty()) read_colour_apart(one.time_ns);
    const auto nearest = std::ranges::min_element(colours_, {}, apart);
    if (nearest != colours_.end() && is_near(*nearest)) {
      const std::string name = fmt::format("{}: {}", files_[std::min(at_, files_.size() - 1)], one.frame.name);
      one.frame.colour =
          registered(nearest->decoded.empty() ? colour_of(parse_picture(nearest->topic, nearest->message, name), name)
                                              : nearest->decoded,
                     one.frame.depth);
    }
    one.frame.up = ups_.up_at(one.time_ns);
    const auto is_past = [&](const Colour& colour) {
      return colour.time_ns < one.time_ns && apart(colour) > kMostApart_ns;
    };
    while (!colours_.empty() && is_past(colours_.front())) forget_colour();
    return std::move(one.frame);
  }

  std::vector<std::string> files_;
  std::vector<std::unique_ptr<Recording>> recordings_;
  std::size_t at_ = 0;  ///< recording that is being read
  /// Readers of colour alone, where the file has it elsewhere, and the one that is being read.
  std::vector<std::unique_ptr<Recording>> apart_;
  std::size_t apart_at_ = 0;
  std::string depth_topic_, colour_topic_;
  Camera camera_;
  StoredDepth stored_;
  std::optional<Rectification> rectification_, colour_rectification_;
  std::optional<ColourRegistration> registration_;
  std::optional<RecordedCameras::Acceleration> acceleration_;
  UpHistory ups_;
  std::vector<std::string> notes_;
  std::vector<SourceItem> items_;
  std::deque<Waiting> waiting_;
  std::deque<Colour> colours_;
  std::size_t colour_bytes_ = 0;
  bool is_colour_lost_ = false;  ///< whether some was forgotten for want of room
  std::unique_ptr<VideoDecoder> video_;
  /// Whether messages of a video were looked at, and one of them was such that decoding can begin.
  enum class VideoKey { none, wanted, seen } video_key_ = VideoKey::none;
  std::optional<std::int64_t> last_time_ns_;  ///< of the frame that was named last
  int of_this_time_ = 0;                      ///< number of frames with this time, one after the other
  TimeSpan span_;
  int left_out_ = 0;                     ///< messages of depth before the first whole picture
  double first_recorded_s_ = 0.0;        ///< when that was recorded
  std::optional<double> last_colour_s_;  ///< time of the latest colour, where it was looked at
  double recorded_later_s_ = 0.0;        ///< by how much messages were recorded after they were taken, about
  /// After a seek, until a frame has come that is not earlier.
  std::optional<double> wanted_from_s_;
  std::exception_ptr failed_;  ///< what could not be read since the last frame that was too early
};

}  // namespace

std::unique_ptr<FrameSource> open_recorded(const std::string& path, const SourceOptions& options) {
  std::vector<std::string> files;
  if (fs::is_directory(path)) {
    files = list_recording(path);
    if (files.empty()) throw Error(path + ": no recording, expected *.mcap, *.db3 or *.bag");
  } else {
    files.push_back(path);
  }
  return std::make_unique<RecordingSource>(std::move(files), options);
}

}  // namespace vesalius
