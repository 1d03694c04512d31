#include "io/files/video_stream.h"

#include "io/files/plain_text.h"

namespace vesalius {

std::string_view video_codec(std::string_view format) {
  const std::string name = lower(format.substr(0, format.find(';')));
  const auto has = [&](std::string_view word) { return name.find(word) != name.npos; };
  if (has("264") || has("avc")) return "h264";
  return has("265") || has("hevc") ? "hevc" : "";
}

bool is_key_message(std::string_view codec, std::string_view message) {
  using namespace std::literals;
  constexpr std::string_view kStart = "\0\0\1"sv;  // of a unit; what it is stands behind
  constexpr int kAvcSets = 7, kHevcSets = 33, kHevcFirst = 16, kHevcLast = 21;
  const bool is_avc = codec == "h264";
  bool sets = false, picture = is_avc;  // H.264 may be refreshed piece by piece, without a picture that needs no other
  for (std::size_t at = message.find(kStart); at != message.npos; at = message.find(kStart, at + kStart.size())) {
    if (at + kStart.size() >= message.size()) break;
    const unsigned head = static_cast<unsigned char>(message[at + kStart.size()]);
    const int type = int(is_avc ? head & 0x1FU : head >> 1U & 0x3FU);
    sets = sets || type == (is_avc ? kAvcSets : kHevcSets);
    picture = picture || (type >= kHevcFirst && type <= kHevcLast);
  }
  return sets && picture;
}

}  // namespace vesalius
