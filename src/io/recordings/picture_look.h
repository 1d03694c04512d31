#pragma once

#include <string>

#include "io/recordings/picture_message.h"

namespace vesalius {

/// What a picture is, as far as that shows without decoding it.
struct PictureLook {
  enum class Kind {
    depth,    ///< distances
    sixteen,  ///< 16 bits, of depth or of infrared
    colour,
    grey,   ///< 8 bits, or 16 that may be depth
    unread  ///< none that can be read
  };
  Kind kind = Kind::unread;
  std::string encoding;       ///< how it is encoded, in a word or two
  int width = 0, height = 0;  ///< 0 = not said
  std::string why;            ///< why it cannot be read
  bool needs_others = false;  ///< of a video: whether a later picture may be one with which decoding can begin
  bool is_depth() const { return kind == Kind::depth || kind == Kind::sixteen; }
};

/// Looks at the head of a picture; of kinds that libavcodec decodes, at the picture.
PictureLook look_at(const PictureMessage& picture);

}  // namespace vesalius
