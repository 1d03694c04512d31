// In place of av_pictures.cpp where libavcodec was not found.
#include <fmt/format.h>

#include "io/files/av_pictures.h"
#include "io/files/image_bytes.h"
#include "vesalius/error.h"

namespace vesalius {

struct VideoDecoder::State {};

bool has_avcodec() { return false; }

AvPicture decode_av_picture(std::string_view bytes, const std::string& name) {
  throw Error(fmt::format("{}: this build cannot read {}; install libavformat-dev and build again", name,
                          av_picture_kind(bytes)));
}

std::pair<int, int> video_size(std::string_view /*codec*/, std::string_view /*message*/) { return {0, 0}; }

VideoDecoder::VideoDecoder(std::string_view codec) {
  throw Error(fmt::format("this build cannot decode {}; install libavformat-dev and build again", codec));
}
VideoDecoder::~VideoDecoder() = default;
std::vector<VideoDecoder::Picture> VideoDecoder::decode(std::string_view /*message*/, std::int64_t /*time_ns*/) {
  return {};
}
void VideoDecoder::restart() {}

}  // namespace vesalius
