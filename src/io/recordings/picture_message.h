#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace vesalius {

/// A picture as a message has it: sensor_msgs/Image and CompressedImage, foxglove.RawImage and CompressedImage; the
/// disparities of a stereo_msgs/DisparityImage; the rows of points of a sensor_msgs/PointCloud2.
struct PictureMessage {
  std::int64_t time_ns = 0;  ///< time of the header; 0 = not given
  std::string frame;         ///< name of the camera's coordinate frame
  bool compressed = false;
  int width = 0, height = 0;  ///< 0 where it is compressed
  std::string encoding;  ///< e.g. "16UC1"; of a compressed one its format, e.g. "jpeg"; of points "xyz" or "xyz rgb"
  std::uint32_t row_bytes = 0;  ///< from one row to the next
  bool big_endian = false;
  std::string_view data;                        ///< into the message, or into what follows
  std::shared_ptr<const std::string> unpacked;  ///< of JSON: what the message has in base64
  double focal_baseline =
      0.0;  ///< of disparities: focal length (pixels) times baseline (metres); 0 = of another picture
  std::uint32_t point_bytes = 0;       ///< of points: from one to the next
  std::array<std::uint32_t, 3> xyz{};  ///< of points: where in one x, y and z lie (float, metres)
  std::optional<std::uint32_t> rgb;    ///< of points: where in one the colour lies, 0xRRGGBB in 32 bits
};

/// Throws Error naming `name` unless a raw picture has a size and all of its rows.
void expect_rows(const PictureMessage& picture, std::size_t pixel_bytes, const std::string& name);

}  // namespace vesalius
