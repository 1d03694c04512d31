#pragma once

#include <string_view>

namespace vesalius {

/// Returns the codec that the format of a message names, "h264" or "hevc"; nothing for other formats. Known are those
/// of foxglove.CompressedVideo ("h265"), ffmpeg_image_transport ("libx264", "hevc;yuv420p;bgr8") and image_transport.
std::string_view video_codec(std::string_view format);

/// Returns whether decoding of a codec's video (Annex B of H.264 and H.265) can begin with a message: it has parameter
/// sets, and of H.265 a picture that needs no other.
bool is_key_message(std::string_view codec, std::string_view message);

}  // namespace vesalius
