#include "io/files/av_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "io/files/image_bytes.h"
#include "io/files/plain_text.h"
#include "io/files/rgb_of_yuv.h"
#include "io/files/video_stream.h"
#include "vesalius/error.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
}

namespace vesalius {
namespace {

template <auto Free>
struct FreeBy {
  template <class T>
  void operator()(T* it) const {
    Free(&it);
  }
};
using Context = std::unique_ptr<AVCodecContext, FreeBy<avcodec_free_context>>;
using Packet = std::unique_ptr<AVPacket, FreeBy<av_packet_free>>;
using AvFrame = std::unique_ptr<AVFrame, FreeBy<av_frame_free>>;

/// `layer` is that of an OpenEXR whose channels are taken.
Context open_decoder(AVCodecID id, const std::string& what, const std::string& layer = {}) {
  av_log_set_level(AV_LOG_QUIET);  // what is wrong is told by errors
  const AVCodec* codec = avcodec_find_decoder(id);
  Context context(codec == nullptr ? nullptr : avcodec_alloc_context3(codec));
  if (!context) throw Error(what + ": the libavcodec of this machine does not decode it");
  context->thread_count = 1;
  context->max_pixels = kMaxPixels;
  context->flags |= AV_CODEC_FLAG_LOW_DELAY | AV_CODEC_FLAG_BITEXACT;
  if (!layer.empty()) av_opt_set(context->priv_data, "layer", layer.c_str(), 0);
  if (avcodec_open2(context.get(), codec, nullptr) != 0) throw Error(what + ": libavcodec does not start");
  return context;
}

Packet packet_of(std::string_view bytes, std::int64_t time_ns) {
  Packet packet(av_packet_alloc());
  constexpr std::size_t kMost = std::numeric_limits<int>::max() / 2;
  if (bytes.size() > kMost || !packet || av_new_packet(packet.get(), int(bytes.size())) != 0) return nullptr;
  std::memcpy(packet->data, bytes.data(), bytes.size());
  packet->pts = time_ns;
  return packet;
}

/// Returns a value of `from` bits as one of eight.
std::uint8_t byte_of(std::uint16_t value, int from) {
  return static_cast<std::uint8_t>(from >= 8 ? value >> (from - 8) : value * 255 / ((1 << from) - 1));
}

/// The rows of a picture of any format of pixels, a channel each.
class Rows {
 public:
  explicit Rows(const AVFrame& frame)
      : frame_(frame), format_(*av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format))) {
    for (auto& row : rows_) row.resize(std::size_t(frame.width));
  }
  bool is_grey() const { return format_.nb_components < 3 && !has(AV_PIX_FMT_FLAG_PAL); }
  bool is_depth() const { return is_grey() && format_.comp[0].depth == 16; }
  bool has(std::uint64_t flag) const { return (format_.flags & flag) != 0; }
  int bits(int channel) const { return format_.comp[channel].depth; }

  void read(int v, int channel) {
    // Two components in the middle of a video's format have fewer rows and columns.
    const bool is_small = !has(AV_PIX_FMT_FLAG_RGB) && (channel == 1 || channel == 2);
    const int by_x = is_small ? format_.log2_chroma_w : 0, by_y = is_small ? format_.log2_chroma_h : 0;
    const int count = (frame_.width + (1 << by_x) - 1) >> by_x;
    auto& row = rows_[std::size_t(channel)];
    av_read_image_line2(row.data(), const_cast<const std::uint8_t**>(frame_.data), frame_.linesize, &format_, 0,
                        v >> by_y, channel, count, has(AV_PIX_FMT_FLAG_PAL) ? 1 : 0, sizeof(std::uint16_t));
    for (int u = frame_.width - 1; by_x > 0 && u >= 0; --u) row[std::size_t(u)] = row[std::size_t(u >> by_x)];
  }
  std::uint16_t value(int u, int channel) const { return rows_[std::size_t(channel)][std::size_t(u)]; }
  std::uint8_t byte(int u, int channel) const { return byte_of(value(u, channel), bits(channel)); }

 private:
  const AVFrame& frame_;
  const AVPixFmtDescriptor& format_;
  std::array<std::vector<std::uint16_t>, 3> rows_;
};

ColourImage colour_of(const AVFrame& frame) {
  Rows rows(frame);
  const int channels = rows.is_grey() ? 1 : 3;
  const bool is_rgb = rows.has(AV_PIX_FMT_FLAG_RGB) || rows.has(AV_PIX_FMT_FLAG_PAL);
  const auto format = static_cast<AVPixelFormat>(frame.format);
  const bool is_full = frame.color_range == AVCOL_RANGE_JPEG || format == AV_PIX_FMT_YUVJ420P ||
                       format == AV_PIX_FMT_YUVJ422P || format == AV_PIX_FMT_YUVJ444P;
  ColourImage colour(frame.width, frame.height);
  for (int v = 0; v < frame.height; ++v) {
    for (int c = 0; c < channels; ++c) rows.read(v, c);
    for (int u = 0; u < frame.width; ++u) {
      const std::uint8_t y = rows.byte(u, 0);
      if (channels == 1) {
        colour(u, v) = {y, y, y};
      } else if (is_rgb) {
        colour(u, v) = {y, rows.byte(u, 1), rows.byte(u, 2)};
      } else {
        colour(u, v) = rgb_of_yuv(is_full ? 16 + y * 219 / 255 : y, rows.byte(u, 1), rows.byte(u, 2));
      }
    }
  }
  return colour;
}

Image<std::uint16_t> whole_numbers_of(const AVFrame& frame) {
  Rows rows(frame);
  Image<std::uint16_t> image(frame.width, frame.height);
  for (int v = 0; v < frame.height; ++v) {
    rows.read(v, 0);
    for (int u = 0; u < frame.width; ++u) image(u, v) = rows.value(u, 0);
  }
  return image;
}

/// Returns the floats of a picture; of several planes, which are alike where depth was written as colour, the first.
/// Nothing where they differ.
Image<float> floats_of(const AVFrame& frame) {
  Image<float> image(frame.width, frame.height);
  const bool has_planes = frame.data[1] != nullptr;
  for (int v = 0; v < frame.height; ++v) {
    const auto row = [&](int plane) { return frame.data[plane] + std::ptrdiff_t{frame.linesize[plane]} * v; };
    const std::size_t bytes = sizeof(float) * std::size_t(frame.width);
    std::memcpy(image.row(v), row(0), bytes);
    if (has_planes && std::memcmp(row(0), row(1), bytes) != 0) return {};
  }
  return image;
}

/// Returns the number of `count` bytes at a place, the lowest first; more than there are bytes where the text ends
/// before.
std::uint64_t number_at(std::string_view bytes, std::uint64_t at, std::size_t count) {
  if (at > bytes.size() || bytes.size() - at < count) return bytes.size() + 1;
  std::uint64_t value = 0;
  for (std::size_t i = count; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// What stands where in an OpenEXR file: attributes (name, type, size, value), then where each block of rows begins.
struct ExrHead {
  std::vector<std::string_view> channels;  ///< names
  std::uint64_t blocks = 0;
};

ExrHead exr_head(std::string_view bytes) {
  ExrHead head;
  std::uint64_t at = 8;
  const auto text = [&] {
    const std::string_view found = bytes.substr(std::min<std::uint64_t>(at, bytes.size()));
    at += std::min(found.find('\0'), found.size()) + 1;
    return found.substr(0, found.find('\0'));
  };
  while (at < bytes.size() && bytes[at] != '\0') {
    const bool is_list = text() == "channels";
    text();
    const std::uint64_t end = at + 4 + number_at(bytes, at, 4);
    constexpr std::uint64_t kOfChannel = 16;  // type, four bytes, steps in x and y
    for (at += 4; is_list && at + 1 < std::min<std::uint64_t>(end, bytes.size()); at += kOfChannel) {
      head.channels.push_back(text());
    }
    at = end;
  }
  head.blocks = at + 1;
  return head;
}

/// libavcodec reads a channel Y. Calls that of depth so by its last letter, and all others by none that it knows.
/// Returns the letters before, the layer for libavcodec. Of pictures of colours, and of none, nothing is changed.
std::string call_depth_y(std::string& bytes) {
  const std::vector<std::string_view> channels = exr_head(bytes).channels;
  const auto is_depth = [&](std::string_view name) {
    const std::string text = lower(name);
    const std::string x = std::string(name.substr(0, name.size() - 1)) + (name.ends_with('z') ? "x" : "X");
    const bool is_z = (text == "z" || text.ends_with(".z")) && std::ranges::count(channels, x) == 0;
    return channels.size() == 1 || is_z || text.find("depth") != text.npos;
  };
  const auto depth = std::ranges::find_if(channels, is_depth);
  if (depth == channels.end() || depth->empty()) return {};
  std::string layer(depth->substr(0, depth->size() - 1));
  for (const std::string_view name : channels) {
    if (!name.empty()) bytes[std::size_t(&name.back() - bytes.data())] = name.data() == depth->data() ? 'Y' : '_';
  }
  return layer;
}

bool is_cut_exr(std::string_view bytes) {
  constexpr unsigned kTiled = 2;  // tiles have four numbers before their size, rows one
  const std::uint64_t blocks = exr_head(bytes).blocks, first = number_at(bytes, blocks, 8);
  std::uint64_t last = first;
  for (std::uint64_t at = blocks; at + 8 <= std::min<std::uint64_t>(first, bytes.size()); at += 8) {
    last = std::max(last, number_at(bytes, at, 8));
  }
  if (last >= bytes.size()) return true;
  const std::uint64_t size_at = last + (static_cast<unsigned>(bytes[5]) & kTiled ? 16 : 4);
  return number_at(bytes, size_at, 4) > bytes.size() - std::min<std::uint64_t>(size_at + 4, bytes.size());
}

/// Returns whether the end of a file is missing. Of some kinds the decoder gives what is there.
bool is_cut(std::string_view kind, std::string_view bytes) {
  if (kind == "WebP") return number_at(bytes, 4, 4) > bytes.size() - std::min<std::size_t>(8, bytes.size());
  return kind == "OpenEXR" && is_cut_exr(bytes);
}

AVCodecID picture_codec(std::string_view kind) {
  if (kind == "TIFF") return AV_CODEC_ID_TIFF;
  if (kind == "WebP") return AV_CODEC_ID_WEBP;
  if (kind == "BMP") return AV_CODEC_ID_BMP;
  return AV_CODEC_ID_EXR;
}

AVCodecID video_codec_id(std::string_view codec) { return codec == "h264" ? AV_CODEC_ID_H264 : AV_CODEC_ID_HEVC; }

}  // namespace

bool has_avcodec() { return true; }

AvPicture decode_av_picture(std::string_view bytes, const std::string& name) {
  const std::string_view kind = av_picture_kind(bytes);
  std::string named(kind == "OpenEXR" ? bytes : "");
  const std::string layer = call_depth_y(named);
  const Context context = open_decoder(picture_codec(kind), fmt::format("{}: {}", name, kind), layer);
  const Packet packet = packet_of(named.empty() ? bytes : named, 0);
  const AvFrame frame(av_frame_alloc());
  const bool is_decoded = packet && frame && avcodec_send_packet(context.get(), packet.get()) == 0 &&
                          avcodec_send_packet(context.get(), nullptr) == 0 &&
                          avcodec_receive_frame(context.get(), frame.get()) == 0;
  if (!is_decoded || is_cut(kind, bytes)) {
    throw Error(fmt::format("{}: damaged {}, or one of a kind that is not read", name, kind));
  }
  check_image_size(frame->width, frame->height, name);
  const Rows rows(*frame);
  if (rows.has(AV_PIX_FMT_FLAG_FLOAT) && rows.bits(0) == 32) {
    Image<float> floats = floats_of(*frame);
    if (floats.empty()) throw Error(fmt::format("{}: {} of colours, expected one channel, or Z", name, kind));
    return {{}, {}, std::move(floats)};
  }
  if (rows.is_depth()) return {{}, whole_numbers_of(*frame), {}};
  return {colour_of(*frame), {}, {}};
}

std::pair<int, int> video_size(std::string_view codec, std::string_view message) {
  if (!is_key_message(codec, message)) return {0, 0};
  VideoDecoder decoder(codec);
  std::vector<VideoDecoder::Picture> pictures = decoder.decode(message, 0);
  if (pictures.empty()) pictures = decoder.decode({}, 0);
  if (pictures.empty()) return {0, 0};
  return {pictures.front().colour.width(), pictures.front().colour.height()};
}

struct VideoDecoder::State {
  std::string codec;
  Context context;
  AvFrame frame{av_frame_alloc()};
  bool begun = false;  ///< whether there was a message at which decoding can begin
};

VideoDecoder::VideoDecoder(std::string_view codec) : state_(std::make_unique<State>()) {
  state_->codec = codec;
  state_->context = open_decoder(video_codec_id(codec), state_->codec);
}

VideoDecoder::~VideoDecoder() = default;

std::vector<VideoDecoder::Picture> VideoDecoder::decode(std::string_view message, std::int64_t time_ns) {
  State& s = *state_;
  s.begun = s.begun || is_key_message(s.codec, message);
  if (!s.begun) return {};
  const Packet packet = message.empty() ? nullptr : packet_of(message, time_ns);
  if (!message.empty() && !packet) return {};
  if (avcodec_send_packet(s.context.get(), packet.get()) != 0) return {};
  std::vector<Picture> pictures;
  while (avcodec_receive_frame(s.context.get(), s.frame.get()) == 0) {
    pictures.push_back({s.frame->pts, vesalius::colour_of(*s.frame)});
  }
  return pictures;
}

void VideoDecoder::restart() {
  avcodec_flush_buffers(state_->context.get());
  state_->begun = false;
}

}  // namespace vesalius
