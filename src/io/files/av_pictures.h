#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vesalius/image.h"

namespace vesalius {

/// Pictures and video that libavcodec of FFmpeg decodes, where this build has it.

bool has_avcodec();

/// A picture of one kind of file; one of the three is filled.
struct AvPicture {
  ColourImage colour;
  Image<std::uint16_t> whole;  ///< depth: grey of 16 bits
  Image<float> real;           ///< depth: grey of floats
};

/// Decodes a picture that `av_picture_kind` knows (io/files/image_bytes.h). Throws Error naming `name` if it is
/// damaged, too large, or this build has no libavcodec.
AvPicture decode_av_picture(std::string_view bytes, const std::string& name);

/// Returns width and height of a video's picture, if decoding can begin with this message; otherwise 0. The codec is
/// one of `video_codec` (io/files/video_stream.h).
std::pair<int, int> video_size(std::string_view codec, std::string_view message);

/// Decodes the pictures of a video one after the other.
class VideoDecoder {
 public:
  /// A picture, and the time that was given with it.
  struct Picture {
    std::int64_t time_ns = 0;
    ColourImage colour;
  };
  /// Throws Error if this build has no such codec.
  explicit VideoDecoder(std::string_view codec);
  ~VideoDecoder();
  VideoDecoder(const VideoDecoder&) = delete;
  VideoDecoder& operator=(const VideoDecoder&) = delete;

  /// Returns the pictures that are complete with a message, in the order of their times; none where it is damaged, or
  /// waits for others. An empty message gives those that still wait.
  std::vector<Picture> decode(std::string_view message, std::int64_t time_ns);
  /// Forgets all pictures: the next message is not the one behind the last.
  void restart();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vesalius
