#include "io/recordings/picture_message.h"

#include <fmt/format.h>

#include "io/files/image_bytes.h"
#include "vesalius/error.h"

namespace vesalius {

void expect_rows(const PictureMessage& picture, std::size_t pixel_bytes, const std::string& name) {
  const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
  if (width == 0 || height == 0 || width * height > kMaxPixels) {
    throw Error(fmt::format("{}: a picture of {}x{}, expected at most {} pixels", name, width, height, kMaxPixels));
  }
  if (picture.row_bytes < width * pixel_bytes || picture.data.size() / picture.row_bytes < height) {
    throw Error(fmt::format("{}: a picture of {}x{} {} with {} bytes, {} to a row", name, width, height,
                            picture.encoding, picture.data.size(), picture.row_bytes));
  }
}

}  // namespace vesalius
