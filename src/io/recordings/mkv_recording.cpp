#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <utility>
#include <vector>

#include "io/files/data_file.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/imu_messages.h"
#include "io/recordings/k4a_messages.h"
#include "io/recordings/matroska_end.h"
#include "io/recordings/message_fields.h"
#include "io/recordings/recording_formats.h"
#include "io/recordings/transform_messages.h"
#include "vesalius/error.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/dict.h>
#include <libavutil/log.h>
}

namespace vesalius {
namespace {

constexpr AVRational kNanosecond{1, 1'000'000'000};
/// Packets of tracks that belong together lie so much apart in the file at most.
constexpr std::int64_t kLead_ns = 1'000'000'000;
/// Later times are damage; these can be added without overflow.
constexpr std::int64_t kMostTime_ns = std::int64_t{1} << 61;

struct CloseInput {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};

std::string tag_of(const AVDictionary* tags, const char* key) {
  const AVDictionaryEntry* entry = av_dict_get(tags, key, nullptr, 0);
  return entry == nullptr ? std::string() : entry->value;
}

/// Returns whether a track is the one of this purpose ("DEPTH"), by the recorder's tag or its own name.
bool is_for(const AVStream& stream, const std::string& purpose) {
  return !tag_of(stream.metadata, fmt::format("K4A_{}_TRACK", purpose).c_str()).empty() ||
         tag_of(stream.metadata, "title") == purpose;
}

constexpr std::uint32_t four(const char (&text)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = code << 8U | static_cast<unsigned char>(text[i]);
  return code;
}

/// Ways in which colour is recorded: name in the file, encoding of a message, bytes of a row's pixel.
struct ColourFormat {
  std::uint32_t tag;
  const char* encoding;
  std::uint32_t row_pixel_bytes;
};
constexpr std::array<ColourFormat, 3> kColourFormats{
    {{four("NV12"), "nv12", 1}, {four("YUY2"), "yuv422_yuy2", 2}, {four("BGRA"), "bgra8", 4}}};

class MkvRecording final : public Recording {
 public:
  explicit MkvRecording(std::string path) : path_(std::move(path)), packet_(av_packet_alloc()) {
    av_log_set_level(AV_LOG_QUIET);  // what is wrong is told by errors and notes
    note_end();
    open();
    describe();
    rewind();
  }

  const std::vector<RecordedTopic>& topics() const override { return topics_; }

  std::optional<RecordedMessage> next() override {
    if (at_calibration_ < calibration_.size()) {
      const auto& [topic, message] = calibration_[at_calibration_++];
      return RecordedMessage{topic, first_ns_, message};
    }
    while (context_ && read_packet()) {
      const auto topic = topic_of_.find(packet_->stream_index);
      const std::int64_t pts = packet_->pts != AV_NOPTS_VALUE ? packet_->pts : packet_->dts;
      if (topic == topic_of_.end() || pts == AV_NOPTS_VALUE || packet_->size <= 0) continue;
      const AVStream& stream = *context_->streams[packet_->stream_index];
      const std::int64_t since_start_ns = av_rescale_q(pts, stream.time_base, kNanosecond);
      if (since_start_ns < -kMostTime_ns || since_start_ns > kMostTime_ns) continue;
      const std::int64_t time_ns = offset_ns_ + since_start_ns;
      message_ = message_of(packet_->stream_index, time_ns);
      return RecordedMessage{topic->second, time_ns, message_};
    }
    return std::nullopt;
  }

  void rewind() override {
    open();
    at_calibration_ = 0;
  }

  std::optional<std::int64_t> last_ns() const override {
    if (duration_ns_ <= 0) return first_ns_;
    return offset_ns_ + duration_ns_;
  }

  bool seek(std::int64_t time_ns) override {
    at_calibration_ = calibration_.size();
    if (time_ns > first_ns_ + kLead_ns && seek_depth(time_ns - kLead_ns - offset_ns_)) return true;
    open();
    return false;
  }

  std::vector<std::string> notes() const override { return notes_; }

 private:
  /// Starts at the beginning; the demuxer's own way back there fails in files without an index.
  void open() {
    context_.reset();
    AVFormatContext* context = avformat_alloc_context();
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    const int status =
        avformat_open_input(&context, ("file:" + path_).c_str(), av_find_input_format("matroska"), &options);
    av_dict_free(&options);
    if (status < 0) {
      std::array<char, AV_ERROR_MAX_STRING_SIZE> why{};
      av_strerror(status, why.data(), why.size());
      throw Error(fmt::format("{}: not Matroska that can be read: {}", path_, why.data()));
    }
    context_.reset(context);
  }

  bool read_packet() {
    av_packet_unref(packet_.get());
    return av_read_frame(context_.get(), packet_.get()) >= 0;
  }

  bool seek_depth(std::int64_t time_ns) {
    const std::int64_t pts = av_rescale_q(time_ns, kNanosecond, context_->streams[depth_]->time_base);
    return av_seek_frame(context_.get(), depth_, pts, AVSEEK_FLAG_BACKWARD) >= 0;
  }

  /// A file that ends early, or was never ended.
  void note_end() {
    const DataFile file(path_);
    const std::optional<std::uint64_t> end = stated_matroska_end(file.read(0, kMatroskaHead));
    if (!end) {
      notes_.push_back(path_ + ": has no end, as a recorder leaves it that was killed; its whole frames are read");
    } else if (*end > file.size()) {
      notes_.push_back(
          fmt::format("{}: cut short at byte {} of {}; the whole frames before it are read", path_, file.size(), *end));
    }
  }

  /// Finds the tracks and makes messages of the calibration.
  void describe() {
    const std::string offset = tag_of(context_->metadata, "K4A_START_OFFSET_NS");
    std::from_chars(offset.data(), offset.data() + offset.size(), offset_ns_);
    if (offset_ns_ < -kMostTime_ns || offset_ns_ > kMostTime_ns) offset_ns_ = 0;
    first_ns_ = offset_ns_;
    if (context_->duration > 0) {
      duration_ns_ = std::min(kMostTime_ns, av_rescale_q(context_->duration, {1, AV_TIME_BASE}, kNanosecond));
    }
    for (unsigned i = 0; i < context_->nb_streams; ++i) look_at(int(i));
    if (depth_ < 0) {
      throw Error(path_ +
                  ": no depth, expected a track of the codec b16g that is named DEPTH; a film of 16-bit depth: "
                  "ffmpeg -i x.mkv -pix_fmt gray16be depth/%04d.png");
    }
    add_topic(depth_, "/depth/image", "sensor_msgs/Image");
    if (colour_ >= 0) {
      const bool is_jpeg = context_->streams[colour_]->codecpar->codec_id == AV_CODEC_ID_MJPEG;
      add_topic(colour_, "/color/image", is_jpeg ? "sensor_msgs/CompressedImage" : "sensor_msgs/Image");
    }
    if (imu_ >= 0) add_topic(imu_, "/imu", "sensor_msgs/Imu");
    describe_cameras();
  }

  void look_at(int index) {
    const AVStream& stream = *context_->streams[index];
    const AVCodecParameters& codec = *stream.codecpar;
    if (codec.codec_type == AVMEDIA_TYPE_VIDEO && codec.codec_tag == four("b16g")) {
      // Infrared is recorded in the same way.
      if (is_for(stream, "DEPTH") || (depth_ < 0 && !is_for(stream, "IR"))) depth_ = index;
    } else if (codec.codec_type == AVMEDIA_TYPE_VIDEO && colour_ < 0) {
      format_ = nullptr;
      for (const ColourFormat& one : kColourFormats) {
        if (codec.codec_tag == one.tag) format_ = &one;
      }
      if (codec.codec_id == AV_CODEC_ID_MJPEG || format_ != nullptr) {
        colour_ = index;
      } else if (is_for(stream, "COLOR")) {
        notes_.push_back(path_ + ": no colour, since its codec is none of MJPEG, NV12, YUY2 and BGRA");
      }
    } else if (is_for(stream, "IMU")) {
      imu_ = index;
    } else if (codec.codec_type == AVMEDIA_TYPE_ATTACHMENT &&
               tag_of(stream.metadata, "filename") == "calibration.json") {
      calibration_json_.assign(reinterpret_cast<const char*>(codec.extradata),
                               static_cast<std::size_t>(codec.extradata_size));
    }
  }

  void add_topic(int track, const char* name, const char* type) {
    topic_of_[track] = topics_.size();
    topics_.push_back({name, type, MessageLayout::cdr, -1});
  }

  void add_calibration(const char* name, const char* type, std::string message) {
    calibration_.emplace_back(topics_.size(), std::move(message));
    topics_.push_back({name, type, MessageLayout::cdr, 1});
  }

  void describe_cameras() {
    if (calibration_json_.empty()) return;
    const K4aCalibration calibration = parse_k4a_calibration(calibration_json_, path_ + ": calibration.json");
    const AVCodecParameters& depth = *context_->streams[depth_]->codecpar;
    if (const auto camera = k4a_depth_calibration(calibration, depth.width, depth.height)) {
      add_calibration("/depth/camera_info", "sensor_msgs/CameraInfo", calibration_message(*camera, first_ns_));
    } else {
      notes_.push_back(fmt::format("{}: depth of {}x{} pixels is of no mode that calibration.json is for", path_,
                                   depth.width, depth.height));
    }
    std::vector<FrameTransform> transforms;
    if (colour_ >= 0 && calibration.colour) {
      const AVCodecParameters& colour = *context_->streams[colour_]->codecpar;
      if (const auto camera = k4a_colour_calibration(calibration, colour.width, colour.height)) {
        add_calibration("/color/camera_info", "sensor_msgs/CameraInfo", calibration_message(*camera, first_ns_));
      }
      transforms.push_back({kK4aDepthFrame, kK4aColourFrame, calibration.colour->sensor_from_depth.inverse()});
    }
    if (calibration.accelerometer_from_depth) {
      transforms.push_back({kK4aDepthFrame, kK4aAccelerometerFrame, calibration.accelerometer_from_depth->inverse()});
    }
    add_calibration("/tf_static", "tf2_msgs/TFMessage", transforms_message(transforms, first_ns_));
  }

  std::string message_of(int track, std::int64_t time_ns) const {
    const std::string_view bytes(reinterpret_cast<const char*>(packet_->data), static_cast<std::size_t>(packet_->size));
    const AVCodecParameters& codec = *context_->streams[track]->codecpar;
    if (track == imu_) {
      const K4aAcceleration measured = parse_k4a_acceleration(bytes, path_);
      return acceleration_message({measured.time_ns, kK4aAccelerometerFrame, measured.m_s2});
    }
    PictureMessage picture;
    picture.time_ns = time_ns;
    picture.frame = track == depth_ ? kK4aDepthFrame : kK4aColourFrame;
    picture.width = codec.width;
    picture.height = codec.height;
    picture.data = bytes;
    if (track == depth_) {
      picture.encoding = "16UC1";
      picture.big_endian = true;
      picture.row_bytes = static_cast<std::uint32_t>(codec.width) * sizeof(std::uint16_t);
    } else if (format_ != nullptr) {
      picture.encoding = format_->encoding;
      picture.row_bytes = static_cast<std::uint32_t>(codec.width) * format_->row_pixel_bytes;
    } else {
      picture.encoding = "jpeg";
      picture.compressed = true;
    }
    return picture_message(picture);
  }

  std::string path_;
  std::unique_ptr<AVFormatContext, CloseInput> context_;
  std::unique_ptr<AVPacket, FreePacket> packet_;
  int depth_ = -1, colour_ = -1, imu_ = -1;  ///< tracks; -1 = none
  const ColourFormat* format_ = nullptr;     ///< format of colour; null = MJPEG
  std::int64_t offset_ns_ = 0;               ///< the device's time at the beginning
  std::int64_t first_ns_ = 0, duration_ns_ = 0;
  std::vector<RecordedTopic> topics_;
  std::map<int, std::size_t> topic_of_;  ///< by track
  std::string calibration_json_;
  std::vector<std::pair<std::size_t, std::string>> calibration_;  ///< messages with their topics, that come first
  std::size_t at_calibration_ = 0;
  std::string message_;
  std::vector<std::string> notes_;
};

}  // namespace

bool has_mkv() { return true; }

std::unique_ptr<Recording> open_mkv(const std::string& path) { return std::make_unique<MkvRecording>(path); }

}  // namespace vesalius
