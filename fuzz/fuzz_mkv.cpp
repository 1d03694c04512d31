// What is read of an Azure Kinect's file besides its container, which libavformat takes apart.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/lens/lens.h"
#include "io/recordings/camera_messages.h"
#include "io/recordings/k4a_messages.h"
#include "io/recordings/matroska_end.h"
#include "vesalius/error.h"

namespace {

using namespace vesalius;

void read_calibration(std::string_view text) {
  const K4aCalibration calibration = parse_k4a_calibration(text, "fuzz");
  const RecordedTopic topic{"/camera_info", "sensor_msgs/CameraInfo", MessageLayout::cdr, 1};
  for (const auto& camera :
       {k4a_depth_calibration(calibration, 640, 576), k4a_colour_calibration(calibration, 1280, 720)}) {
    if (!camera) continue;
    const Calibration back = parse_calibration(topic, calibration_message(*camera, 0), "fuzz");
    if (back.distortion != camera->distortion || back.matrix != camera->matrix) __builtin_trap();
    make_lens(back.model, back.distortion);
  }
}

void read_picture(std::string_view packet, const char* encoding) {
  if (packet.size() < 2) return;
  PictureMessage picture;
  picture.width = static_cast<unsigned char>(packet[0]);
  picture.height = static_cast<unsigned char>(packet[1]);
  picture.encoding = encoding;
  picture.compressed = picture.encoding == "jpeg";
  picture.row_bytes = static_cast<std::uint32_t>(picture.width) * (picture.encoding == "nv12" ? 1 : 2);
  picture.big_endian = true;
  picture.data = picture.compressed ? packet : packet.substr(2);
  if (is_depth(picture)) {
    depth_of(picture, {}, "fuzz");
  } else {
    colour_of(picture, "fuzz");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    switch (data[0]) {
      case 'C':
        read_calibration(rest);
        break;
      case 'E':
        stated_matroska_end(rest);
        break;
      case 'A':
        parse_k4a_acceleration(rest, "fuzz");
        break;
      case 'D':
        read_picture(rest, "16UC1");
        break;
      case 'N':
        read_picture(rest, "nv12");
        break;
      case 'Y':
        read_picture(rest, "yuv422_yuy2");
        break;
      default:
        read_picture(rest, "jpeg");
    }
  } catch (const Error&) {
  }
  return 0;
}
