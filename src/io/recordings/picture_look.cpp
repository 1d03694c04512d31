#include "io/recordings/picture_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "io/files/av_pictures.h"
#include "io/files/image_bytes.h"
#include "io/files/video_stream.h"
#include "io/recordings/colour_encodings.h"
#include "io/recordings/depth_codecs.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using namespace std::literals;
using Kind = PictureLook::Kind;

std::uint32_t number(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8U | static_cast<unsigned char>(bytes[at + std::size_t(i)]);
  return value;
}

int side(std::uint32_t value) { return int(std::min<std::int64_t>(value, kMaxPixels)); }

/// Sizes, bits of a channel and channels, as the heads of files say them.
struct Head {
  std::string_view kind;
  int width = 0, height = 0, bits = 8, channels = 3;
};

Head png_head(std::string_view bytes) {
  constexpr std::size_t kSizes = 16, kBits = 24, kEnd = 26;
  if (bytes.size() < kEnd) return {"PNG"};
  const bool is_grey = bytes[kBits + 1] == 0;
  return {"PNG", side(number(bytes, kSizes, 4)), side(number(bytes, kSizes + 4, 4)), int(number(bytes, kBits, 1)),
          is_grey ? 1 : 3};
}

Head jpeg_head(std::string_view bytes) {
  for (std::size_t at = 2; at + 10 <= bytes.size();) {
    const std::uint32_t marker = number(bytes, at + 1, 1);
    const bool has_size = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (has_size) {
      return {"JPEG", int(number(bytes, at + 7, 2)), int(number(bytes, at + 5, 2)), 8, int(number(bytes, at + 9, 1))};
    }
    at += 2 + number(bytes, at + 2, 2);
  }
  return {"JPEG"};
}

/// Of pictures that are decoded for it: few cameras record such.
Head av_head(std::string_view bytes) {
  Head head{av_picture_kind(bytes)};
  if (head.kind.empty() || !has_avcodec()) return head;
  try {
    const AvPicture picture = decode_av_picture(bytes, "");
    const bool is_depth = picture.colour.empty();
    head.width = std::max({picture.colour.width(), picture.whole.width(), picture.real.width()});
    head.height = std::max({picture.colour.height(), picture.whole.height(), picture.real.height()});
    if (is_depth) head.bits = 16, head.channels = 1;
  } catch (const Error&) {  // whoever asks for the frame hears of it
  }
  return head;
}

Head head_of(std::string_view bytes) {
  if (is_png(bytes)) return png_head(bytes);
  if (is_jpeg(bytes)) return jpeg_head(bytes);
  return av_head(bytes);
}

constexpr std::array kDepthEncodings{"16UC1", "16SC1", "32SC1", "32FC1", "64FC1", "z16", "Z16"};

/// Pictures that were of 16 bits or of metres before they were compressed: "16UC1; jpeg compressed".
bool says_depth(const std::string& format) {
  return std::ranges::any_of(kDepthEncodings, [&](const char* one) { return format.starts_with(one); });
}

PictureLook look_at_video(const PictureMessage& picture, std::string_view codec) {
  PictureLook look{Kind::unread, picture.encoding, 0, 0, {}};
  std::tie(look.width, look.height) = video_size(codec, picture.data);
  if (look.width > 0) {
    look.kind = Kind::colour;
  } else {
    look.needs_others = has_avcodec();
    look.why = has_avcodec() ? "no picture of this video can be decoded without others before it"
                             : "video is not read without libavcodec";
  }
  return look;
}

PictureLook look_at_compressed(const PictureMessage& picture) {
  if (const std::string_view codec = video_codec(picture.encoding); !codec.empty())
    return look_at_video(picture, codec);
  // image_transport's formats end with a space.
  const std::string format = picture.encoding.substr(0, picture.encoding.find_last_not_of(' ') + 1);
  PictureLook look{Kind::unread, format, 0, 0, {}};
  if (picture.encoding.find("compressedDepth") != std::string::npos) {
    look.kind = Kind::depth;
    if (format.ends_with("rvl")) {
      std::tie(look.width, look.height) = rvl_size(picture.data);
    } else {
      const Head head = head_of(without_compressed_depth_head(picture.data));
      look.width = head.width;
      look.height = head.height;
    }
    return look;
  }
  const Head head = head_of(picture.data);
  look.width = head.width;
  look.height = head.height;
  const std::string_view kind = head.kind.empty() ? "this format" : head.kind;
  const bool is_read = head.width > 0, is_16 = is_read && head.bits == 16 && head.channels == 1;
  if (is_16) {
    look.kind = says_depth(picture.encoding) ? Kind::depth : Kind::sixteen;
  } else if (says_depth(picture.encoding)) {
    look.why = head.kind == "JPEG" || head.kind == "PNG"
                   ? fmt::format("{} bits of a {} are no distances; compressedDepth keeps them", head.bits, head.kind)
                   : fmt::format("{} is not read, expected a 16-bit PNG or compressedDepth", kind);
  } else if (is_read || head.kind == "PNG" || head.kind == "JPEG") {
    look.kind = head.channels == 1 ? Kind::grey : Kind::colour;
  } else {
    look.why = fmt::format("{} is not read{}, expected JPEG or PNG", kind, has_avcodec() ? "" : " without libavcodec");
  }
  return look;
}

}  // namespace

PictureLook look_at(const PictureMessage& picture) {
  if (picture.compressed) return look_at_compressed(picture);
  const std::string& e = picture.encoding;
  PictureLook look{Kind::unread, e, picture.width, picture.height, {}};
  if (picture.focal_baseline > 0.0 || picture.point_bytes > 0 || std::ranges::count(kDepthEncodings, e) > 0) {
    look.kind = Kind::depth;
  } else if (e == "mono16") {
    look.kind = Kind::sixteen;
  } else if (is_colour_encoding(e)) {
    look.kind = is_grey_encoding(e) ? Kind::grey : Kind::colour;
  } else {
    look.why = "this encoding is not read";
  }
  return look;
}

}  // namespace vesalius
