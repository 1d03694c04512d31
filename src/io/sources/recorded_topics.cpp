#include "io/sources/recorded_topics.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <exception>
#include <map>

#include "io/recordings/camera_topics.h"
#include "io/recordings/message_fields.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Messages in which every topic must have shown itself, once there are depth and a calibration.
constexpr int kMostProbed = 5000;
/// After that, so long transforms may still come.
constexpr std::int64_t kForTransforms_ns = 1'000'000'000;
/// So long topics are waited for that may have no message at all.
constexpr std::int64_t kForOthers_ns = 20'000'000'000;
/// Messages of a topic of which one must be a whole picture.
constexpr int kMostLeftOut = 100;
/// Messages of a video of which one must be such that decoding can begin with it.
constexpr int kMostWithoutKey = 1000;
/// Messages of depth after the first; if all of them have another size, that one was odd.
constexpr int kConfirming = 2;

bool has_word(const std::string& text, std::string_view word) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), same) != text.end();
}

struct Word {
  std::string_view begins;
  TopicName says;
  bool whole = false;  ///< whether nothing may follow
};
constexpr std::array<Word, 26> kWords{
    {{"rgbd", TopicName::nothing},    {"depthai", TopicName::nothing},   {"depth", TopicName::depth},
     {"color", TopicName::colour},    {"colour", TopicName::colour},     {"rgb", TopicName::colour},
     {"bgr", TopicName::colour},      {"mono", TopicName::colour, true}, {"grey", TopicName::colour},
     {"gray", TopicName::colour},     {"ir", TopicName::other, true},    {"infra", TopicName::other},
     {"thermal", TopicName::other},   {"lepton", TopicName::other},      {"flir", TopicName::other},
     {"confid", TopicName::other},    {"dispar", TopicName::other},      {"intensity", TopicName::other},
     {"amplitude", TopicName::other}, {"ambient", TopicName::other},     {"reflec", TopicName::other},
     {"label", TopicName::other},     {"mask", TopicName::other},        {"segment", TopicName::other},
     {"index", TopicName::other},     {"parts", TopicName::other}}};

/// Returns the words of a part of a name: runs of letters, in lower case.
std::vector<std::string> words_of(std::string_view part) {
  std::vector<std::string> words(1);
  for (const char c : part) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalpha(letter) != 0) {
      words.back() += static_cast<char>(std::tolower(letter));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  return words;
}

/// RealSense cameras: how many metres a unit of depth is, as a number (ROS 1) or as text (ROS 2).
bool is_depth_unit(const RecordedTopic& topic) {
  const bool is_value = topic.type == "std_msgs/Float32" || topic.type == "std_msgs/String";
  return is_value && is_ros(topic) && topic.name.ends_with("/Depth_Units/value");
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

bool is_whole(const PictureMessage& picture, const PictureLook& look) {
  if (picture.data.empty()) return false;
  if (picture.compressed) return look.kind == PictureLook::Kind::unread || (look.width > 0 && look.height > 0);
  return look.width > 0 && look.height > 0 && picture.data.size() / picture.height >= picture.row_bytes;
}

PictureTopic seen(const RecordedTopic& topic, const RecordedMessage& message, const std::string& place) {
  const PictureMessage picture = parse_picture(topic, message.bytes, place);
  const std::int64_t time_ns = picture.time_ns != 0 ? picture.time_ns : message.time_ns;
  PictureTopic one{topic, look_at(picture), name_says(topic.name), plain_frame(picture.frame), picture.compressed};
  one.points = topic.type == "sensor_msgs/PointCloud2";
  one.disparities = picture.focal_baseline > 0.0;
  one.time_s = double(time_ns) / double(kNanoseconds);
  one.recorded_s = double(message.time_ns) / double(kNanoseconds);
  return one;
}

/// Some drivers give the rectified pictures' matrix alone.
Calibration with_matrix(Calibration c) {
  const auto& p = c.projection;
  c.frame = plain_frame(c.frame);
  if (c.matrix[0] == 0.0 && p[0] > 0.0) c.matrix = {p[0], 0, p[2], 0, p[5], p[6], 0, 0, 1};
  return c;
}

class Looking {
 public:
  Looking(Recording& recording, const std::string& place) : recording_(recording), place_(place) {
    for (std::size_t t = 0; t < recording.topics().size(); ++t) {
      const RecordedTopic& topic = recording.topics()[t];
      if (topic.messages == 0) continue;
      const bool matters = is_picture(topic) || is_calibration(topic) || is_acceleration(topic) || is_depth_unit(topic);
      if (matters) wanted_[t] = {};
      if (is_transform(topic)) has_transforms_ = true;
    }
  }

  RecordedContents look() {
    bool is_essential = lacks_essential();
    std::optional<std::int64_t> first_ns, complete_ns;
    for (int left = kMostProbed; left > 0 && (!wanted_.empty() || has_transforms_);) {
      const std::optional<RecordedMessage> message = next();
      if (!message || (complete_ns && is_later(message->time_ns, *complete_ns, kForTransforms_ns))) break;
      if (!first_ns) first_ns = message->time_ns;
      if (!is_essential) --left;
      const bool is_late = is_later(message->time_ns, *first_ns, kForOthers_ns);
      if (is_late && !complete_ns && std::ranges::all_of(wanted_, [&](auto& one) { return may_be_empty(one.first); })) {
        break;
      }
      if (!take(*message)) continue;
      is_essential = lacks_essential();
      if (wanted_.empty() && !complete_ns) complete_ns = message->time_ns;
    }
    recording_.rewind();
    if (failed_ && contents_.pictures.empty()) std::rethrow_exception(failed_);
    return std::move(contents_);
  }

 private:
  /// Returns the next message that is not damaged. Whoever asks for the frames hears of those before it.
  std::optional<RecordedMessage> next() {
    constexpr int kMostFailed = 100;
    for (int i = 0; i < kMostFailed; ++i) {
      try {
        return recording_.next();
      } catch (const Error&) {
        if (!failed_) failed_ = std::current_exception();
      }
    }
    return std::nullopt;
  }

  const RecordedTopic& topic(std::size_t number) const { return recording_.topics()[number]; }
  bool may_be_empty(std::size_t number) const { return topic(number).messages < 0; }

  /// Returns whether there is no depth that is called so, or no calibration that fits some, where either must come.
  bool lacks_essential() const {
    const auto must_come = [&](const auto& which) {
      return std::ranges::any_of(wanted_,
                                 [&](const auto& one) { return !may_be_empty(one.first) && which(topic(one.first)); });
    };
    const auto called = [](const PictureTopic& one) { return one.look.is_depth() && one.name == TopicName::depth; };
    const auto is_depth = [](const PictureTopic& one) { return one.look.is_depth() && !one.points; };
    const auto any = [&](const auto& which) { return std::ranges::any_of(contents_.pictures, which); };
    if (!any(called) && must_come([&](const RecordedTopic& of) {
          return is_picture(of) && (name_says(of.name) == TopicName::depth || !any(is_depth));
        })) {
      return true;
    }
    const auto fits = [&](const PictureTopic& one) {
      return one.look.is_depth() && std::ranges::any_of(contents_.calibrations, [&](const auto& calibration) {
               return scaled_to(calibration.second, one.look.width, one.look.height).has_value();
             });
    };
    return !any(fits) && must_come([](const RecordedTopic& of) { return is_calibration(of); });
  }

  /// What is known of a topic that is still looked at.
  struct Wanted {
    int left_out = 0;   ///< messages that are no whole pictures
    int confirmed = 0;  ///< messages of another size than the first whole picture, one after the other
  };

  /// Returns whether the message was of a topic that is looked at.
  bool take(const RecordedMessage& message) {
    const RecordedTopic& of = topic(message.topic);
    if (is_transform(of)) {
      for (const FrameTransform& one : parse_transforms(of, message.bytes, place_)) contents_.transforms.add(one);
    }
    const auto found = wanted_.find(message.topic);
    if (found == wanted_.end()) return false;
    if (is_picture(of)) {
      if (!take_picture(of, message, found->second)) return true;
    } else if (is_calibration(of)) {
      contents_.calibrations.emplace_back(of.name, with_matrix(parse_calibration(of, message.bytes, place_)));
    } else if (is_acceleration(of)) {
      contents_.accelerations.emplace_back(of.name, parse_acceleration(of, message.bytes, place_));
    } else {
      contents_.units_m.emplace_back(of.name, depth_unit(of, message, place_));
    }
    wanted_.erase(found);
    return true;
  }

  /// Returns whether nothing more is to be learned from the topic.
  bool take_picture(const RecordedTopic& of, const RecordedMessage& message, Wanted& wanted) {
    const auto known = std::ranges::find(contents_.pictures, of.name, [](const auto& one) { return one.topic.name; });
    const std::optional<PictureLook> look = whole_picture(of, message.bytes);
    if (known == contents_.pictures.end()) {
      if (!look) return ++wanted.left_out >= kMostLeftOut;
      contents_.pictures.push_back(seen(of, message, place_));
      contents_.pictures.back().left_out = wanted.left_out;
      if (look->needs_others) return false;
      return !look->is_depth() || of.messages - wanted.left_out <= kConfirming;
    }
    if (known->look.needs_others) {
      if (!look || look->needs_others) return ++wanted.left_out >= kMostWithoutKey;
      *known = seen(of, message, place_);
      return true;
    }
    if (!look || (look->width == known->look.width && look->height == known->look.height)) return true;
    if (++wanted.confirmed < kConfirming) return false;
    const int left_out = known->left_out + 1;
    *known = seen(of, message, place_);
    known->left_out = left_out;
    return true;
  }

  Recording& recording_;
  const std::string& place_;
  RecordedContents contents_;
  std::map<std::size_t, Wanted> wanted_;  ///< topics that have not shown themselves
  bool has_transforms_ = false;
  std::exception_ptr failed_;  ///< the first that could not be read
};

}  // namespace

std::string_view without_transport(std::string_view topic) {
  for (const std::string_view transport : {"/compressed", "/compressedDepth"}) {
    if (topic.ends_with(transport)) return topic.substr(0, topic.size() - transport.size());
  }
  return topic;
}

TopicName name_says(std::string_view topic) {
  if (const int stream = orbbec_stream(topic); stream != 0) {
    return stream == kOrbbecDepth ? TopicName::depth : stream == kOrbbecColour ? TopicName::colour : TopicName::other;
  }
  topic = without_transport(topic);
  TopicName says = TopicName::nothing;
  while (!topic.empty()) {
    const std::string_view part = topic.substr(0, topic.find('/'));
    topic.remove_prefix(std::min(topic.size(), part.size() + 1));
    for (const std::string& word : words_of(part)) {
      if (word == "to") break;
      const auto found = std::ranges::find_if(
          kWords, [&](const Word& one) { return one.whole ? word == one.begins : word.starts_with(one.begins); });
      if (found != kWords.end() && found->says != TopicName::nothing) says = found->says;
    }
  }
  return says;
}

bool PictureTopic::is_registered() const {
  return has_word(topic.name, "aligned") || has_word(topic.name, "registered");
}
bool PictureTopic::is_rectified() const { return has_word(topic.name, "rect"); }

std::optional<PictureLook> whole_picture(const RecordedTopic& topic, std::string_view message) {
  try {
    const PictureMessage picture = parse_picture(topic, message, topic.name);
    PictureLook look = look_at(picture);
    if (is_whole(picture, look)) return look;
  } catch (const Error&) {  // whoever asks for the frame hears of it
  }
  return std::nullopt;
}

RecordedContents look_into(Recording& recording, const std::string& place) { return Looking(recording, place).look(); }

}  // namespace vesalius
